#pragma once

#include <exception>
#include <string>

namespace evbench {

/// What nlohmann's JSON library says of an error, without the tag that it begins with ("[json.exception...] ").
inline std::string json_reason(const std::exception& error) {
  const std::string message = error.what();
  const std::size_t end = message.starts_with('[') ? message.find("] ") : std::string::npos;
  return end == std::string::npos ? message : message.substr(end + 2);
}

}  // namespace evbench
