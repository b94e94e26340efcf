#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace evbench {

/// Bytes to be decoded: a file, or memory in tests.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// [bytes]; 0 where nobody knows before the end is read (a file in a .zip).
  virtual std::uint64_t size() const = 0;
  /// Reads from `offset` on, as many as there are; returns their number, 0 from the end on.
  virtual std::size_t read(std::uint64_t offset, std::span<std::byte> out) = 0;
  /// For messages.
  virtual const std::string& name() const = 0;
};

/// Throws InputError when it is no regular file that can be read.
class FileBytes : public ByteSource {
 public:
  explicit FileBytes(std::string path);
  ~FileBytes() override;
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;
  std::uint64_t size() const override { return size_; }
  std::size_t read(std::uint64_t offset, std::span<std::byte> out) override;
  const std::string& name() const override { return path_; }

 private:
  std::string path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// A whole file. Throws InputError for one of more than `most` bytes, and says what was expected, e.g. "a calibration".
std::string read_small_file(const std::string& path, std::uint64_t most, const std::string& what);

/// Bytes that somebody else keeps.
class MemoryBytes : public ByteSource {
 public:
  MemoryBytes(std::span<const std::byte> bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}
  std::uint64_t size() const override { return bytes_.size(); }
  std::size_t read(std::uint64_t offset, std::span<std::byte> out) override;
  const std::string& name() const override { return name_; }

 private:
  std::span<const std::byte> bytes_;
  std::string name_;
};

}  // namespace evbench
