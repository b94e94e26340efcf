#pragma once

#include <string>

namespace evbench {

/// A big file that appears under its name only when it is complete, whoever writes it and however that ends: until
/// commit() it has no name in its folder (Linux' O_TMPFILE), so that nothing is left even of a program that is killed.
/// Where the file system can't do that, it is `path`.part and disappears with the object.
///
/// write_file() (atomic_file.hpp) is for content that is there at once.
class PartFile {
 public:
  /// `named`: `path`.part in any case, for libraries that don't write to a file without a name (HDF5).
  /// Throws InputError when the folder is missing or can't be written to, and when `path` is a folder.
  explicit PartFile(const std::string& path, bool named = false);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  /// A path by which the file can be opened, and written, as long as this object lives.
  const std::string& writable_path() const { return writable_path_; }

  /// What is written is on the disk and has its name, replacing an older file. Throws InputError when it can't.
  void commit();

 private:
  std::string path_, part_, writable_path_;
  int descriptor_ = -1;
  bool nameless_ = false;
};

}  // namespace evbench
