#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace evbench {

/// A file's bytes in memory, read by the kernel as they are touched. The file may be replaced by a rename while it is
/// mapped, but not be shortened: the kernel ends a program that touches what is gone (SIGBUS). expect_whole() before a
/// part is read makes that an error, unless the file is shortened in that very moment.
class FileMapping {
 public:
  /// Throws InputError when it is no regular file that can be read.
  explicit FileMapping(const std::string& path);
  ~FileMapping();
  FileMapping(const FileMapping&) = delete;
  FileMapping& operator=(const FileMapping&) = delete;

  std::span<const std::byte> bytes() const { return {data_, size_}; }

  /// Throws InputError when the file has been shortened since it was mapped. Takes less than a microsecond.
  void expect_whole() const;

  /// These bytes are done with: their pages no longer count as this program's memory. They can be read again.
  void forget(std::size_t offset, std::size_t size) const;

 private:
  std::string path_;
  int descriptor_ = -1;
  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace evbench
