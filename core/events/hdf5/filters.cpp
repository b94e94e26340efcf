#include "core/events/hdf5/filters.hpp"

#include <hdf5.h>
#include <zstd.h>

#include <algorithm>

namespace evbench::hdf5 {
namespace {

constexpr H5Z_filter_t kLzf = 32000, kZstd = 32015;
constexpr std::size_t kMostChunkBytes = 256u << 20;  ///< of a chunk

/// Replaces a filter's input buffer by its result.
std::size_t replace(std::span<const std::byte> out, std::size_t* buffer_size, void** buffer) {
  void* const memory = H5allocate_memory(std::max<std::size_t>(out.size(), 1), false);
  if (memory == nullptr) return 0;
  std::copy(out.begin(), out.end(), static_cast<std::byte*>(memory));
  H5free_memory(*buffer);
  *buffer = memory;
  *buffer_size = out.size();
  return out.size();
}

std::span<const std::byte> input(std::size_t bytes, void* const* buffer) {
  return {static_cast<const std::byte*>(*buffer), bytes};
}

// Exceptions must not pass through the library, which is C. 0 is an error. Compressing always is one: the library then
// leaves a chunk as it is.

std::size_t lzf_filter(unsigned flags, std::size_t count, const unsigned values[], std::size_t bytes,
                       std::size_t* buffer_size, void** buffer) {
  if ((flags & H5Z_FLAG_REVERSE) == 0) return 0;
  try {
    const std::size_t size = count >= 3 && values[2] > 0 ? values[2] : kMostChunkBytes;
    const auto out = decompress_lzf(input(bytes, buffer), std::min(size, kMostChunkBytes));
    return out ? replace(*out, buffer_size, buffer) : 0;
  } catch (const std::exception&) {
    return 0;
  }
}

std::size_t zstd_filter(unsigned flags, std::size_t, const unsigned[], std::size_t bytes, std::size_t* buffer_size,
                        void** buffer) {
  if ((flags & H5Z_FLAG_REVERSE) == 0) return 0;
  try {
    const auto in = input(bytes, buffer);
    const unsigned long long size = ZSTD_getFrameContentSize(in.data(), in.size());
    if (size > kMostChunkBytes) return 0;  // the codes of "unknown" and "error", too
    std::vector<std::byte> out(size);
    const std::size_t made = ZSTD_decompress(out.data(), out.size(), in.data(), in.size());
    return ZSTD_isError(made) || made != out.size() ? 0 : replace(out, buffer_size, buffer);
  } catch (const std::exception&) {
    return 0;
  }
}

}  // namespace

std::optional<std::vector<std::byte>> decompress_lzf(std::span<const std::byte> in, std::size_t size) {
  constexpr std::size_t kMostGrowth = 264 / 3;  // the longest copy takes three bytes
  std::vector<std::byte> out(std::min(size, kMostGrowth * in.size()));
  std::size_t at = 0, made = 0;
  const auto next = [&] { return at < in.size() ? std::to_integer<std::size_t>(in[at++]) : 0; };
  while (at < in.size()) {
    const std::size_t control = next();
    if (control < 32) {
      const std::size_t length = control + 1;
      if (length > in.size() - at || length > out.size() - made) return std::nullopt;
      std::copy_n(in.data() + at, length, out.data() + made);
      at += length;
      made += length;
      continue;
    }
    std::size_t length = (control >> 5) + 2;
    if (length == 9) length += next();
    if (at == in.size()) return std::nullopt;
    const std::size_t distance = ((control & 31) << 8) + next() + 1;
    if (distance > made || length > out.size() - made) return std::nullopt;
    std::byte* const to = out.data() + made;
    if (distance >= length) {
      std::copy_n(to - distance, length, to);
    } else {
      const std::byte* const from = to - distance;
      for (std::size_t i = 0; i < length; ++i) to[i] = from[i];  // it may copy its own output
    }
    made += length;
  }
  out.resize(made);
  return out;
}

void register_filters() {
  static const H5Z_class2_t lzf{H5Z_CLASS_T_VERS, kLzf, 1, 1, "lzf (evbench)", nullptr, nullptr, lzf_filter};
  static const H5Z_class2_t zstd{H5Z_CLASS_T_VERS, kZstd, 1, 1, "zstd (evbench)", nullptr, nullptr, zstd_filter};
  static const bool registered = H5Zregister(&lzf) >= 0 && H5Zregister(&zstd) >= 0;
  static_cast<void>(registered);
}

std::string filter_hint(int filter) {
  switch (filter) {
    case 307: return "bzip2, in Debian's package hdf5-filter-plugin";
    case 32001: return "blosc, in Debian's package hdf5-filter-plugin-blosc-serial";
    case 32004: return "lz4, in Debian's package hdf5-filter-plugin";
    case 32008: return "bitshuffle, in Debian's package python3-hdf5plugin";
    case 32013: return "zfp, in Debian's package hdf5-filter-plugin-zfp-serial";
    default: return "in no package of Debian 12 that evbench knows";
  }
}

}  // namespace evbench::hdf5
