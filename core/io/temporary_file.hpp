#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace evbench {

/// The folder for temporary files: $TMPDIR ($TMP, $TEMP, $TEMPDIR), or /tmp. Throws OutputError with the variable if
/// the folder does not exist.
std::string temporary_folder();

/// A temporary file that is removed with the object, for data that libraries or other processes read by a path. All
/// functions throw OutputError if it can't be written.
class TemporaryFile {
 public:
  TemporaryFile();
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write(std::span<const std::byte> bytes);
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  int file_ = -1;
};

}  // namespace evbench
