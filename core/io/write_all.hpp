#pragma once

#include <cstddef>
#include <span>

namespace evbench {

/// Writes all bytes to a file, however many calls that takes. Returns an error of errno; 0 when all is well.
int write_all(int file, std::span<const std::byte> bytes);

}  // namespace evbench
