#pragma once

#include <concepts>
#include <cstddef>

namespace evbench {

/// A count or number that is known not to be negative, as a container's index.
constexpr std::size_t index(std::integral auto i) { return static_cast<std::size_t>(i); }

}  // namespace evbench
