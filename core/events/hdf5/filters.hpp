#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace evbench::hdf5 {

/// Registers what the library's own plugins lack in Debian 12: lzf (the plugin there doesn't load) and zstd (there is
/// none). Other filters come from plugins. May be called again.
void register_filters();

/// For a message: a filter's name and Debian's package.
std::string filter_hint(int filter);

/// LibLZF's format: a control byte below 32 is followed by one literal more than its value; others are copies, of
/// (control >> 5) + 2 bytes (the next byte is added to the length if that is 9) from up to 8192 bytes back. None when
/// the data are broken or longer than `size`.
std::optional<std::vector<std::byte>> decompress_lzf(std::span<const std::byte> in, std::size_t size);

}  // namespace evbench::hdf5
