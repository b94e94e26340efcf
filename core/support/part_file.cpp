#include "core/support/part_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "core/support/error.hpp"

namespace evbench {
namespace {

[[noreturn]] void fail(const std::string& path, int error) {
  throw InputError(fmt::format("{}: can't be written: {}", path, std::strerror(error)));
}

}  // namespace

PartFile::PartFile(const std::string& path, bool named) : path_(path), part_(path + ".part") {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw InputError(fmt::format("{}: is a folder; expected a file name", path));
  }
  std::string folder = std::filesystem::path(path).parent_path().string();
  if (folder.empty()) folder = ".";
  if (!named) descriptor_ = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0644);
  nameless_ = descriptor_ >= 0;
  if (!nameless_) descriptor_ = ::open(part_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor_ < 0) fail(path_, errno);
  writable_path_ = nameless_ ? fmt::format("/proc/self/fd/{}", descriptor_) : part_;
}

PartFile::~PartFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  if (!nameless_) ::unlink(part_.c_str());
}

void PartFile::commit() {
  // A full disk is noticed here and not lost.
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) fail(path_, errno);
  if (nameless_) {  // linkat() does not replace: by way of the .part name
    ::unlink(part_.c_str());
    if (::linkat(AT_FDCWD, writable_path_.c_str(), AT_FDCWD, part_.c_str(), AT_SYMLINK_FOLLOW) != 0) fail(path_, errno);
  }
  if (::rename(part_.c_str(), path_.c_str()) != 0) {
    const int error = errno;
    ::unlink(part_.c_str());
    fail(path_, error);
  }
  ::close(descriptor_);
  descriptor_ = -1;
}

}  // namespace evbench
