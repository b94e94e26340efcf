#pragma once

#include <string>

namespace evbench {

/// A file that appears under its name only when it is complete. Until commit() it has no name in its folder (Linux'
/// O_TMPFILE), so that even a killed program leaves nothing. If the file system does not support that, it has a unique
/// name next to `path` (`path`.part and the process id) and is removed with the object. A symbolic link is kept: its
/// target is replaced, with the target's permissions.
///
/// Pipes and devices are written to directly, if the writer can do so.
class PartFile {
 public:
  /// What a writer requires of the file.
  enum class Needs {
    nothing,  ///< it is written from beginning to end: a pipe or a device suffices
    seeking,  ///< the writer seeks in it
    name,     ///< likewise, and the writer can't write to a file without a name (HDF5)
  };

  /// Throws InputError if the folder is missing or not writable, if `path` is a folder, and if it is a pipe or device
  /// that does not meet the writer's needs.
  explicit PartFile(const std::string& path, Needs needs = Needs::seeking);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  /// A path for opening and writing the file, valid during this object's lifetime.
  const std::string& writable_path() const { return writable_path_; }

  /// Flushes the file to the disk and gives it its name, replacing an older file. Throws InputError on failure.
  void commit();

 private:
  template <class Try>
  void take_name(Try succeeds);

  std::string path_;    ///< as given
  std::string target_;  ///< target of its links
  std::string part_;    ///< the temporary name; empty: none (yet)
  std::string writable_path_;
  int descriptor_ = -1;  ///< none for a pipe or device
};

}  // namespace evbench
