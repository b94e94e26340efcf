#include "core/support/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "core/support/error.hpp"
#include "core/support/part_file.hpp"
#include "core/support/path.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail(const std::string& path, const char* what, int error) {
  throw InputError(fmt::format("{}: {}: {}", path, what, std::strerror(error)));
}

/// Writes and flushes to the disk, so that "disk full" is noticed here and not lost. Errors name the file `shown`.
void write_durably(const std::string& path, std::string_view content, const std::string& shown) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) fail(shown, "can't be written", errno);
  int error = 0;
  while (!content.empty() && error == 0) {
    const ssize_t written = ::write(file, content.data(), content.size());
    if (written < 0) {
      error = errno == EINTR ? 0 : errno;
    } else {
      content.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  if (error == 0 && ::fsync(file) != 0 && errno != EINVAL && errno != EROFS) error = errno;
  if (::close(file) != 0 && error == 0) error = errno;
  if (error != 0) fail(shown, "can't be written", error);
}

/// Opens and locks a file; -1 when another process has it locked. Errors name the folder `shown`.
int open_locked(const std::string& path, const std::string& shown) {
  while (true) {
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file < 0) fail(shown, "can't be written", errno);
    const bool locked = ::flock(file, LOCK_EX | LOCK_NB) == 0;
    struct stat held {
    }, named{};
    const bool same = locked && ::fstat(file, &held) == 0 && ::stat(path.c_str(), &named) == 0 &&
                      held.st_ino == named.st_ino && held.st_dev == named.st_dev;
    if (same) return file;
    ::close(file);
    if (!locked) return -1;
    // The holder removed the file after it was opened here: what is locked now has no name.
  }
}

}  // namespace

void write_file(const std::string& path, std::string_view content) {
  PartFile file(path, PartFile::Needs::nothing);
  write_durably(file.writable_path(), content, path);
  file.commit();
}

AtomicFolder::AtomicFolder(const std::string& path)
    : path_(path),
      target_(follow_links(path)),
      part_(target_ + ".evbench.part"),
      old_(target_ + ".evbench.old"),
      lock_path_(target_ + ".evbench.lock") {
  std::error_code error;
  const fs::path parent = fs::path(target_).parent_path();
  if (!parent.empty()) fs::create_directories(parent, error);
  if (error) throw InputError(fmt::format("{}: can't be made: {}", parent.string(), error.message()));
  lock_ = open_locked(lock_path_, path);
  if (lock_ < 0) {
    throw InputError(fmt::format("{}: another run is writing to this folder; wait for it, or write elsewhere", path));
  }
  std::error_code removal;
  fs::remove_all(part_, removal);  // what a killed run left
  if (!fs::exists(target_, error)) fs::rename(old_, target_, error);
  if (!fs::create_directory(part_, error)) {
    const std::string message = fmt::format("{}: can't be made: {}", path, (error ? error : removal).message());
    ::unlink(lock_path_.c_str());
    ::close(lock_);
    throw InputError(message);
  }
}

AtomicFolder::~AtomicFolder() {
  std::error_code ignored;
  fs::remove_all(part_, ignored);
  ::unlink(lock_path_.c_str());
  ::close(lock_);
}

void AtomicFolder::write(const std::string& name, std::string_view content) const {
  write_durably(part_ + "/" + name, content, path_ + "/" + name);
}

void AtomicFolder::commit() {
  std::error_code error;
  fs::remove_all(old_, error);
  if (fs::exists(target_, error)) fs::rename(target_, old_, error);
  if (error) throw InputError(fmt::format("{}: can't be replaced: {}", path_, error.message()));
  fs::rename(part_, target_, error);
  if (error) {
    std::error_code ignored;
    fs::rename(old_, target_, ignored);  // what was there before stays
    throw InputError(fmt::format("{}: can't be written: {}", path_, error.message()));
  }
  fs::remove_all(old_, error);
}

}  // namespace evbench
