#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace evbench {

/// The folder for temporary files: $TMPDIR ($TMP, $TEMP, $TEMPDIR), or /tmp. Throws OutputError, naming the variable,
/// where there is no such folder.
std::string temporary_folder();

/// A file in the folder for temporary files that disappears with the object: for what has to be read by
/// a path, by libraries that follow it or by other processes. All functions throw OutputError where it can't be
/// written.
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
