#include "core/io/file_mapping.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/support/error.hpp"

namespace evbench {
namespace {

const std::size_t kPage = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));

}  // namespace

FileMapping::FileMapping(const std::string& path)
    : path_(path), descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (descriptor_ < 0) throw InputError(fmt::format("{}: {}", path, std::strerror(errno)));
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(descriptor_);
    throw InputError(fmt::format("{}: is no regular file", path));
  }
  size_ = static_cast<std::size_t>(status.st_size);
  void* const data = size_ == 0 ? nullptr : ::mmap(nullptr, size_, PROT_READ, MAP_SHARED, descriptor_, 0);
  if (data == MAP_FAILED) {
    const int error = errno;
    ::close(descriptor_);
    throw InputError(fmt::format("{}: can't be mapped: {}", path, std::strerror(error)));
  }
  data_ = static_cast<std::byte*>(data);
}

FileMapping::~FileMapping() {
  if (data_ != nullptr) ::munmap(data_, size_);
  ::close(descriptor_);
}

void FileMapping::expect_whole() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) == 0 && static_cast<std::size_t>(status.st_size) >= size_) return;
  throw InputError(
      fmt::format("{}: was shortened, from {} to {} bytes, while it was read", path_, size_, status.st_size));
}

void FileMapping::forget(std::size_t offset, std::size_t size) const {
  const std::size_t from = offset / kPage * kPage, to = std::min(offset + size, size_) / kPage * kPage;
  if (from < to) ::madvise(data_ + from, to - from, MADV_DONTNEED);
}

}  // namespace evbench
