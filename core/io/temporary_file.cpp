#include "core/io/temporary_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>

#include "core/io/write_all.hpp"

namespace evbench {
TemporaryFile::TemporaryFile() : path_((std::filesystem::temp_directory_path() / "evbench-XXXXXX").string()) {
  file_ = ::mkostemp(path_.data(), O_CLOEXEC);
  if (file_ < 0) fail_to_write(path_, errno);
}

TemporaryFile::~TemporaryFile() {
  ::close(file_);
  ::unlink(path_.c_str());
}

void TemporaryFile::write(std::span<const std::byte> bytes) {
  if (const int error = write_all(file_, bytes); error != 0) fail_to_write(path_, error);
}

}  // namespace evbench
