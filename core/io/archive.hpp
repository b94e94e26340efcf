#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "core/support/error.hpp"

struct archive;  // libarchive's

namespace evbench {

/// What is wrong with an archive itself, not with the disk that it is unpacked to.
class BadArchive : public InputError {
 public:
  using InputError::InputError;
};

/// The entries of an archive (zip, tar, tar.gz), one after the other; a compressed file (gzip, bzip2, xz, zstd) is one
/// that has a single entry. Their names are UTF-8, whatever the user's locale
/// is. All functions throw BadArchive, naming the archive, for one that is damaged, for an entry without a name, and
/// for more than a million entries.
class Archive {
 public:
  enum class Kind { file, folder, other };  ///< other: a link or device

  enum class Form { archive, compressed_file };

  explicit Archive(std::string path, Form form = Form::archive);

  /// Goes to the first entry, then to the next one; false at the end.
  bool next();
  const std::string& name() const { return name_; }
  Kind kind() const { return kind_; }

  /// The next bytes of the current file; 0 at its end.
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
