#pragma once

#include <cstddef>
#include <type_traits>

namespace evbench {

/// A number that is known not to be negative, or an enumerator's, as a container's index.
template <class Number>
requires std::is_integral_v<Number> || std::is_enum_v<Number>
constexpr std::size_t index(Number i) { return static_cast<std::size_t>(i); }

}  // namespace evbench
