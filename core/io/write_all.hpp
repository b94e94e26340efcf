#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace evbench {

/// Writes all bytes to a file, in several calls if needed. Returns an errno; 0 on success.
int write_all(int file, std::span<const std::byte> bytes);

/// Throws an OutputError: the file can't be written because of this errno.
[[noreturn]] void fail_to_write(const std::string& path, int error);

}  // namespace evbench
