#include "core/io/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <span>

#include "core/io/part_file.hpp"
#include "core/io/path.hpp"
#include "core/io/write_all.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

/// Writes a file, calls `flush` with its descriptor (returns an errno or 0), and closes it. Errors name the file
/// `shown`.
template <class Flush>
void write_whole(const std::string& path, std::string_view content, const std::string& shown, Flush flush) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) fail_to_write(shown, errno);
  int error = write_all(file, std::as_bytes(std::span(content)));
  if (error == 0) error = flush(file);
  if (::close(file) != 0 && error == 0) error = errno;
  if (error != 0) fail_to_write(shown, error);
}

/// Flushes content and name to the disk. Returns an errno; 0 on success and for pipes and devices.
int flush_durably(int file) { return ::fsync(file) == 0 || errno == EINVAL || errno == EROFS ? 0 : errno; }

/// Flushes the content to the disk, so that "disk full" is noticed and the content is there before the folder gets its
/// name (file systems keep the order of renames). Does not wait for the journal: that takes ten times as long and
/// matters only after a power cut.
int flush_data(int file) {
  constexpr unsigned kAll = SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE | SYNC_FILE_RANGE_WAIT_AFTER;
  const bool full = ::sync_file_range(file, 0, 0, kAll) != 0 && (errno == ENOSPC || errno == EDQUOT || errno == EIO);
  return full ? errno : 0;
}

/// Opens and locks a file; -1 if another process has locked it. Errors name the folder `shown`.
int open_locked(const std::string& path, const std::string& shown) {
  while (true) {
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file < 0) fail_to_write(shown, errno);
    const bool locked = ::flock(file, LOCK_EX | LOCK_NB) == 0;
    struct stat held {
    }, named{};
    const bool same = locked && ::fstat(file, &held) == 0 && ::stat(path.c_str(), &named) == 0 &&
                      held.st_ino == named.st_ino && held.st_dev == named.st_dev;
    if (same) return file;
    ::close(file);
    if (!locked) return -1;
    // The previous holder removed the file after it was opened here: the locked file has no name any more.
  }
}

}  // namespace

void write_file(const std::string& path, std::string_view content) {
  PartFile file(path, PartFile::Needs::nothing);
  write_whole(file.writable_path(), content, path, flush_durably);
  file.commit();
}

void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& read, bool force) {
  std::error_code error;
  std::vector<std::string> files;  // those that exist or will be written
  for (const std::string& path : outputs) {
    if (path.empty()) continue;
    if (path == "-") throw InputError("-: expected a file's name; the standard output is /dev/stdout");
    const bool is_file = fs::is_regular_file(path, error), is_folder = fs::is_directory(path, error);
    if (fs::exists(path, error) && !is_file && !is_folder) continue;
    for (const std::string& other : read) {
      if (!fs::equivalent(path, other, error)) continue;
      throw InputError(fmt::format("{}: is also an input; expected another name for the output", path));
    }
    const std::string place = fs::weakly_canonical(fs::absolute(path, error), error).string();
    if (std::ranges::find(files, place) != files.end()) {
      throw InputError(fmt::format("{}: is given as two outputs; expected a name for each output", path));
    }
    files.push_back(place);
    const bool holds_something = is_file || (is_folder && !fs::is_empty(path, error));
    if (holds_something && !force) throw InputError(fmt::format("{}: exists already; --force replaces it", path));
  }
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
  if (error) throw OutputError(fmt::format("{}: can't be made: {}", parent.string(), error.message()));
  lock_ = open_locked(lock_path_, path);
  if (lock_ < 0) {
    throw FolderTaken(fmt::format("{}: another run is writing to this folder; wait for it, or write elsewhere", path));
  }
  std::error_code removal;
  fs::remove_all(part_, removal);  // leftovers of a killed run
  if (fs::exists(target_, error)) {
    fs::remove_all(old_, removal);
  } else {
    fs::rename(old_, target_, error);
  }
  if (!fs::create_directory(part_, error)) {
    const std::string message = fmt::format("{}: can't be made: {}", path, (error ? error : removal).message());
    ::unlink(lock_path_.c_str());
    ::close(lock_);
    throw OutputError(message);
  }
}

bool AtomicFolder::is_taken(const std::string& path) {
  const int file = ::open((follow_links(path) + ".evbench.lock").c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) return false;
  const bool free = ::flock(file, LOCK_EX | LOCK_NB) == 0;
  ::close(file);
  return !free;
}

void AtomicFolder::clear_leftovers(const std::string& path) {
  std::error_code error;
  if (!fs::exists(follow_links(path) + ".evbench.lock", error)) return;  // the lock is removed last
  try {
    const AtomicFolder folder(path);
  } catch (const FolderTaken&) {  // its writer is still running
  }
}

AtomicFolder::~AtomicFolder() {
  std::error_code ignored;
  fs::remove_all(part_, ignored);
  ::unlink(lock_path_.c_str());
  ::close(lock_);
}

void AtomicFolder::write(const std::string& name, std::string_view content) const {
  write_whole(part_ + "/" + name, content, path_ + "/" + name, flush_data);
}

void AtomicFolder::clear() const {
  std::error_code error;
  fs::remove_all(part_, error);
  if (!error) fs::create_directory(part_, error);
  if (error) throw OutputError(fmt::format("{}: can't be cleared: {}", path_, error.message()));
}

void AtomicFolder::commit() {
  std::error_code error;
  fs::remove_all(old_, error);
  if (fs::exists(target_, error)) fs::rename(target_, old_, error);
  if (error) throw OutputError(fmt::format("{}: can't be replaced: {}", path_, error.message()));
  fs::rename(part_, target_, error);
  if (error) {
    std::error_code ignored;
    fs::rename(old_, target_, ignored);  // the previous content stays
    throw OutputError(fmt::format("{}: can't be written: {}", path_, error.message()));
  }
  fs::remove_all(old_, error);
}

}  // namespace evbench
