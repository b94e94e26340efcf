#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace evbench::hdf5 {

/// Registers the filters that the library's plugins lack in Debian 12: lzf (the plugin there doesn't load) and zstd
/// (there is none). Other filters come from plugins. May be called again.
void register_filters();

/// A filter's name and its Debian package, for messages.
std::string filter_hint(int filter);

/// Decompresses LibLZF's format. A control byte below 32 is followed by one literal more than its value. Other control
/// bytes are copies of (control >> 5) + 2 bytes (the next byte is added to the length if that is 9) from up to 8192
/// bytes back. None if the data are broken or longer than `size`.
std::optional<std::vector<std::byte>> decompress_lzf(std::span<const std::byte> in, std::size_t size);

}  // namespace evbench::hdf5
