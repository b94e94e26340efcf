#include "core/io/part_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>

#include "core/io/path.hpp"
#include "core/io/write_all.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

namespace fs = std::filesystem;

std::string folder_of(const std::string& path) {
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

}  // namespace

/// Creates a temporary name next to the file by `succeeds`, which must fail with EEXIST if the name is taken.
template <class Try>
void PartFile::take_name(Try succeeds) {
  const std::string name = fmt::format("{}.part{}", target_, ::getpid());
  std::string candidate = name;
  for (int i = 1; !succeeds(candidate); ++i) {
    if (errno != EEXIST) fail_to_write(path_, errno);
    candidate = fmt::format("{}-{}", name, i);
  }
  part_ = candidate;
}

PartFile::PartFile(const std::string& path, Needs needs) : path_(path) {
  std::error_code error;
  const fs::file_status there = fs::status(path, error);
  if (fs::is_directory(there)) throw InputError(fmt::format("{}: is a folder; expected a file name", path));
  if (fs::exists(there) && !fs::is_regular_file(there)) {
    if (needs != Needs::nothing) {
      throw InputError(fmt::format("{}: is a pipe or a device; expected a file, as what is written there needs", path));
    }
    writable_path_ = path;
    return;
  }
  target_ = follow_links(path);
  if (needs != Needs::name) {
    descriptor_ = ::open(folder_of(target_).c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0644);
    writable_path_ = fmt::format("/proc/self/fd/{}", descriptor_);
  }
  if (descriptor_ < 0) {
    take_name([&](const std::string& name) {
      descriptor_ = ::open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
      return descriptor_ >= 0;
    });
    writable_path_ = part_;
  }
  if (fs::exists(there)) ::fchmod(descriptor_, static_cast<mode_t>(there.permissions()) & 0777);
}

PartFile::~PartFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  if (!part_.empty()) ::unlink(part_.c_str());
}

void PartFile::commit() {
  if (descriptor_ < 0) return;
  // A full disk is reported here.
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) fail_to_write(path_, errno);
  if (part_.empty()) {  // linkat() does not replace a file, so a temporary name is needed
    take_name([&](const std::string& name) {
      return ::linkat(AT_FDCWD, writable_path_.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
    });
  }
  if (::rename(part_.c_str(), target_.c_str()) != 0) fail_to_write(path_, errno);
  ::close(descriptor_);
  descriptor_ = -1;
}

}  // namespace evbench
