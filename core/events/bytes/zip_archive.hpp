#pragma once

#include <memory>
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

  /// The file of this name, in the archive's highest folder that has one; empty: none.
  std::string find(const std::string& name) const;

  /// A file's content as it is unpacked. Going back in it begins anew. `file`: one of files().
  std::unique_ptr<ByteSource> open(const std::string& file) const;

 private:
  std::string path_;
  std::vector<std::string> files_;
};

}  // namespace evbench
