#pragma once

#include <span>
#include <string>
#include <utility>

namespace evbench {

/// The bytes of a .zip with these files, name and content, in this order. No dates: the same files give the same bytes.
std::string zip(std::span<const std::pair<std::string, std::string>> files);

}  // namespace evbench
