#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace evbench {

/// A file's bytes in memory, read by the kernel as they are touched. The file must not be shortened while it is mapped;
/// replaced by a rename it may be.
class FileMapping {
 public:
  /// Throws InputError when it is no regular file that can be read.
  explicit FileMapping(const std::string& path);
  ~FileMapping();
  FileMapping(const FileMapping&) = delete;
  FileMapping& operator=(const FileMapping&) = delete;

  std::span<const std::byte> bytes() const { return {data_, size_}; }

  /// These bytes are done with: their pages no longer count as this program's memory. They can be read again.
  void forget(std::size_t offset, std::size_t size) const;

 private:
  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace evbench
