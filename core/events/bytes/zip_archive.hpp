#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/io/byte_source.hpp"

namespace evbench {

/// A .zip: its files by name. Nothing is unpacked but what is read, piece by piece; links and folders are no files.
/// Throws BadArchive (core/io/archive.hpp).
class ZipArchive {
 public:
  explicit ZipArchive(std::string path);

  const std::string& path() const { return path_; }
  const std::vector<std::string>& files() const { return files_; }

  /// The files of this name, in whatever folders.
  std::vector<std::string> find(const std::string& name) const;

  /// A file's content as it is unpacked. Going back in it begins anew. `file`: one of files().
  std::unique_ptr<ByteSource> open(const std::string& file) const;

 private:
  std::string path_;
  std::vector<std::string> files_;
};

/// Does a file begin like one that gzip, bzip2, xz or zstd compressed?
bool is_compressed_file(std::span<const std::byte> head);

/// Its content, as a ZipArchive's file. Throws BadArchive.
std::unique_ptr<ByteSource> open_compressed_file(const std::string& path);

}  // namespace evbench
