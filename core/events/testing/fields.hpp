#pragma once

#include <cstdint>
#include <cstring>
#include <string>

/// Fields of binary files, for tests that write some.
namespace evbench::testing {

template <class T>
std::string bytes(T value) {
  std::string text(sizeof(T), '\0');
  std::memcpy(text.data(), &value, sizeof(T));
  return text;
}
inline std::string text(const std::string& characters) {
  return bytes(static_cast<std::uint32_t>(characters.size())) + characters;
}

}  // namespace evbench::testing
