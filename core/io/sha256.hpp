#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

namespace evbench {

/// SHA-256 of data given in parts.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  void add(std::string_view bytes);
  template <class T>
  void add_value(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(std::string_view(reinterpret_cast<const char*>(&value), sizeof value));
  }
  std::string hex();  ///< 64 digits; ends the hash

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

std::string sha256(std::string_view bytes);

/// SHA-256 of a file, as printed by `sha256sum`. Throws InputError if it can't be read.
std::string sha256_file(const std::string& path);

}  // namespace evbench
