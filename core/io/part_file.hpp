#pragma once

#include <string>

namespace evbench {

/// A file that appears under its name only when it is complete, whoever writes it and however that ends: until commit()
/// it has no name in its folder (Linux' O_TMPFILE), so that nothing is left even of a program that is killed. Where the
/// file system can't do that, it has a name beside `path` that nothing else has (`path`.part with this process' number)
/// and disappears with the object. A symbolic link stays one: what it leads to is replaced, with the permissions it
/// has.
///
/// A pipe or a device is no file to be replaced: it is written to at once, where the writer can do so.
class PartFile {
 public:
  /// What a writer asks of the file.
  enum class Needs {
    nothing,  ///< it is written from its beginning to its end: a pipe or a device will do
    seeking,  ///< the writer goes back in it
    name,     ///< likewise, and the writer is a library that can't write to a file without a name (HDF5)
  };

  /// Throws InputError when the folder is missing or can't be written to, when `path` is a folder, and when it is a
  /// pipe or device but the writer needs more.
  explicit PartFile(const std::string& path, Needs needs = Needs::seeking);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  /// A path by which the file can be opened, and written, as long as this object lives.
  const std::string& writable_path() const { return writable_path_; }

  /// What is written is on the disk and has its name, replacing an older file. Throws InputError when it can't.
  void commit();

 private:
  template <class Try>
  void take_name(Try succeeds);

  std::string path_;    ///< as given
  std::string target_;  ///< where its links lead
  std::string part_;    ///< the name beside it; empty: none (yet)
  std::string writable_path_;
  int descriptor_ = -1;  ///< none for a pipe or device
};

}  // namespace evbench
