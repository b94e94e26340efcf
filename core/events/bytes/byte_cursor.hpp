#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/events/bytes/bytes.hpp"

namespace evbench {

/// Reads little-endian fields from bytes. A field beyond the end reads as zero or empty, and ok() is false from then
/// on, so a parser checks once, at its end. Lengths are compared with what is left before anything is allocated.
class ByteCursor {
 public:
  explicit ByteCursor(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  T get() {
    const auto field = bytes(sizeof(T));
    return ok_ ? load<T>(field.data()) : T{};
  }

  std::span<const std::byte> bytes(std::uint64_t count) {
    ok_ = ok_ && count <= left();
    if (!ok_) return {};
    at_ += static_cast<std::size_t>(count);
    return bytes_.subspan(at_ - static_cast<std::size_t>(count), static_cast<std::size_t>(count));
  }

  std::string text(std::uint64_t length) {
    const auto characters = bytes(length);
    return {reinterpret_cast<const char*>(characters.data()), characters.size()};
  }

  /// Advances to the next multiple of `unit` bytes, counted from `base`.
  void align(std::size_t unit, std::size_t base) { bytes((unit - (at_ - base) % unit) % unit); }

  bool ok() const { return ok_; }
  std::size_t at() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

}  // namespace evbench
