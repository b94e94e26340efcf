#include "core/io/temporary_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "core/io/write_all.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

[[noreturn]] void fail(const std::string& path, int error) {
  throw OutputError(fmt::format("{}: can't be written: {}", path, std::strerror(error)));
}

}  // namespace

TemporaryFile::TemporaryFile() : path_((std::filesystem::temp_directory_path() / "evbench-XXXXXX").string()) {
  file_ = ::mkostemp(path_.data(), O_CLOEXEC);
  if (file_ < 0) fail(path_, errno);
}

TemporaryFile::~TemporaryFile() {
  ::close(file_);
  ::unlink(path_.c_str());
}

void TemporaryFile::write(std::span<const std::byte> bytes) {
  if (const int error = write_all(file_, bytes); error != 0) fail(path_, error);
}

}  // namespace evbench
