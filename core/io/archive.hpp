#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "core/support/error.hpp"

struct archive;  // libarchive's

namespace evbench {

/// An error of an archive itself, not of the disk that it is unpacked to.
class BadArchive : public InputError {
 public:
  using InputError::InputError;
};

/// Reads the entries of an archive (zip, tar, tar.gz) one after the other. A compressed file (gzip, bzip2, xz, zstd) is
/// an archive with a single entry. Names of entries are UTF-8, independent of the user's locale. All functions throw
/// BadArchive with the archive's path for a damaged archive, an entry without a name, and more than a million entries.
class Archive {
 public:
  enum class Kind { file, folder, other };  ///< other: a link or device

  enum class Form { archive, compressed_file };

  explicit Archive(std::string path, Form form = Form::archive);

  /// Advances to the first or next entry; false at the end.
  bool next();
  const std::string& name() const { return name_; }
  Kind kind() const { return kind_; }

  /// Reads the next bytes of the current file; returns their number, 0 at its end.
  std::size_t read(std::span<std::byte> out);

 private:
  [[noreturn]] void fail() const;

  std::string path_;
  std::unique_ptr<archive, int (*)(archive*)> archive_;
  int entries_ = 0;
  std::string name_;
  Kind kind_ = Kind::other;
};

}  // namespace evbench
