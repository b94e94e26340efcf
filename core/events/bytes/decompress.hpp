#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace evbench {

/// Each replaces `out` by the decompressed content of `in`, one or several frames. Returns false when `in` is broken,
/// cut short, or has more than `most` bytes of content. Memory grows with the actual content, whatever the headers say.
bool decompress_lz4(std::span<const std::byte> in, std::size_t most, std::vector<std::byte>& out);
bool decompress_zstd(std::span<const std::byte> in, std::size_t most, std::vector<std::byte>& out);
bool decompress_bzip2(std::span<const std::byte> in, std::size_t most, std::vector<std::byte>& out);

}  // namespace evbench
