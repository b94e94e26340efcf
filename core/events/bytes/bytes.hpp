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

}  // namespace evbench
