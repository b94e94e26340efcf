#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace evbench {

/// Writes all bytes to a file, however many calls that takes. Returns an error of errno; 0 when all is well.
int write_all(int file, std::span<const std::byte> bytes);

/// Throws an OutputError that says that the file can't be written, by an error of errno.
[[noreturn]] void fail_to_write(const std::string& path, int error);

}  // namespace evbench
