#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/io/byte_source.hpp"

namespace evbench {

/// A .zip archive: its files by name. Only what is read is unpacked, in parts. Links and folders do not count as files.
/// Throws BadArchive (core/io/archive.hpp).
class ZipArchive {
 public:
  explicit ZipArchive(std::string path);

  const std::string& path() const { return path_; }
  const std::vector<std::string>& files() const { return files_; }

  /// The files of this name in any folder.
  std::vector<std::string> find(const std::string& name) const;

  /// A file's content, unpacked while it is read. Seeking back restarts from the beginning. `file`: one of files().
  std::unique_ptr<ByteSource> open(const std::string& file) const;

 private:
  std::string path_;
  std::vector<std::string> files_;
};

/// Does a file begin like one compressed with gzip, bzip2, xz or zstd?
bool is_compressed_file(std::span<const std::byte> head);

/// Its content, unpacked like that of a ZipArchive's file. Throws BadArchive.
std::unique_ptr<ByteSource> open_compressed_file(const std::string& path);

}  // namespace evbench
