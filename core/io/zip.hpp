#pragma once

#include <span>
#include <string>
#include <utility>

namespace evbench {

/// The bytes of a .zip with these files (name, content) in this order. The dates are fixed: equal files give equal
/// bytes.
std::string zip(std::span<const std::pair<std::string, std::string>> files);

}  // namespace evbench
