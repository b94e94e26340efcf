#include "core/io/temporary_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>

#include "core/io/write_all.hpp"
#include "core/support/error.hpp"

namespace evbench {

std::string temporary_folder() {
  for (const char* name : {"TMPDIR", "TMP", "TEMP", "TEMPDIR"}) {
    const char* const folder = std::getenv(name);
    if (folder == nullptr || *folder == '\0') continue;
    std::error_code error;
    if (std::filesystem::is_directory(folder, error)) return folder;
    throw OutputError(fmt::format("{}: is \"{}\", which is no folder; expected one for temporary files", name, folder));
  }
  return "/tmp";
}

TemporaryFile::TemporaryFile() : path_(temporary_folder() + "/evbench-XXXXXX") {
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
