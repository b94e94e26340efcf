#pragma once

#include <cstddef>
#include <type_traits>

namespace evbench {

/// Converts a non-negative number or an enumerator to a container index.
template <class Number>
requires std::is_integral_v<Number> || std::is_enum_v<Number>
constexpr std::size_t index(Number i) { return static_cast<std::size_t>(i); }

}  // namespace evbench
