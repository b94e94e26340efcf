#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace evbench {

/// A memory-mapped file. The file may be replaced by a rename while it is mapped but must not be shortened: reading the
/// missing part ends the program (SIGBUS). Calling expect_whole() before reading a part turns that into an error,
/// unless the file is shortened at that very moment.
class FileMapping {
 public:
  /// Throws InputError unless it is a readable regular file.
  explicit FileMapping(const std::string& path);
  ~FileMapping();
  FileMapping(const FileMapping&) = delete;
  FileMapping& operator=(const FileMapping&) = delete;

  std::span<const std::byte> bytes() const { return {data_, size_}; }

  /// Throws InputError when the file has been shortened since it was mapped. Takes less than a microsecond.
  void expect_whole() const;

  /// Releases the pages of these bytes, so that they no longer count as this program's memory. They can be read again.
  void forget(std::size_t offset, std::size_t size) const;

 private:
  std::string path_;
  int descriptor_ = -1;
  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace evbench
