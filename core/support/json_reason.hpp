#pragma once

#include <exception>
#include <string>

namespace evbench {

/// The message of an error of nlohmann's JSON library, without the leading tag ("[json.exception...] ").
inline std::string json_reason(const std::exception& error) {
  const std::string message = error.what();
  const std::size_t end = message.starts_with('[') ? message.find("] ") : std::string::npos;
  return end == std::string::npos ? message : message.substr(end + 2);
}

}  // namespace evbench
