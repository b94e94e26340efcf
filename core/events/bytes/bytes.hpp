#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace evbench {

static_assert(std::endian::native == std::endian::little, "files are little-endian, and read as they are");

/// A little-endian number at any address.
template <class T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return value;
}

/// Continues a counter of `bits` bits over its end: a step back by more than half of its range is one forward.
class WrappingCounter {
 public:
  explicit WrappingCounter(int bits) : bits_(bits) {}

  std::int64_t update(std::uint32_t value) {
    if (value < last_ && last_ - value > (std::uint32_t{1} << (bits_ - 1))) ++wraps_;
    last_ = value;
    return (wraps_ << bits_) | value;
  }

 private:
  int bits_;
  std::uint32_t last_ = 0;
  std::int64_t wraps_ = 0;
};

}  // namespace evbench
