#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace evbench {

/// Bytes to decode: a file, or memory in tests.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// [bytes]; 0 if unknown before the end is read (a file in a .zip).
  virtual std::uint64_t size() const = 0;
  /// Reads the available bytes from `offset` on; returns their number, 0 at and beyond the end.
  virtual std::size_t read(std::uint64_t offset, std::span<std::byte> out) = 0;
  /// Name for messages.
  virtual const std::string& name() const = 0;
};

/// The bytes of a file. Throws InputError unless it is a readable regular file.
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

/// Reads a whole file. Throws InputError if it has more than `most` bytes; `what` is the expected content in the
/// message, e.g. "a calibration".
std::string read_small_file(const std::string& path, std::uint64_t most, const std::string& what);

/// Bytes in memory, which must outlive the object.
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
