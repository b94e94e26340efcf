#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace evbench {

/// Each replaces `out` by what `in` holds, and returns false when `in` is broken, cut short, or holds more than `most`
/// bytes. Memory grows with what is really there, whatever the headers say. `in` is one or several frames.
bool decompress_lz4(std::span<const std::byte> in, std::size_t most, std::vector<std::byte>& out);
bool decompress_zstd(std::span<const std::byte> in, std::size_t most, std::vector<std::byte>& out);
bool decompress_bzip2(std::span<const std::byte> in, std::size_t most, std::vector<std::byte>& out);

}  // namespace evbench
