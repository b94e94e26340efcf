#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "core/events/event.hpp"

/// The bytes of the native format, little-endian: header, chunks of events, index of the chunks, metadata.
///
///   offset 0                      Header
///   header.index_offset           Chunk[header.chunks], in time order
///   right behind the index        header.metadata_size bytes of JSON (calibration, ground truth, origin), end of file
///
/// A chunk has one of two layouts. An event is a word, from its lowest bit: polarity (1), x, y, time.
///   wide     64-bit words: x and y of 16 bits, 31 bits of time since the chunk's start [µs].
///   narrow   for each group of 64 events a 32-bit time since the chunk's start [µs], then 32-bit words: x and y of as
///            many bits as the sensor's size needs, the rest is time since the group's. Half the size; used where
///            events are dense enough, which is nearly everywhere.
///
/// The header is written last: an unfinished file has none. Checksums are XXH3 (64 bits) of a chunk's bytes, of index
/// and metadata, and of the header before its own checksum. They are as fast as memory, so that every read verifies
/// them.
namespace evbench::native {

static_assert(std::endian::native == std::endian::little);

inline constexpr char kMagic[8] = {'e', 'v', 'b', 'e', 'n', 'c', 'h', '\n'};
inline constexpr std::uint32_t kVersion = 1;
inline constexpr std::size_t kChunkEvents = 1 << 14;  ///< at most; a decoded chunk stays in the second-level cache
inline constexpr std::size_t kGroupEvents = 64;
inline constexpr std::int64_t kMaxTime = std::int64_t{1} << 62;  ///< [µs] either sign, so that sums never overflow
inline constexpr std::int64_t kMaxSpan = (std::int64_t{1} << 31) - 1;  ///< of a chunk [µs], 35 min

struct Header {
  char magic[8] = {};
  std::uint32_t version = kVersion;
  std::uint32_t width = 0, height = 0;  ///< sensor [px]; 0: unknown
  std::uint32_t chunks = 0;
  std::uint64_t events = 0;
  std::uint64_t index_offset = 0;
  std::uint64_t metadata_size = 0;
  std::uint64_t tail_hash = 0;  ///< of index and metadata
  std::uint64_t hash = 0;       ///< of this header up to here
};
static_assert(sizeof(Header) == 64 && std::is_trivially_copyable_v<Header>);

enum class Layout : std::uint32_t { wide = 0, narrow = 1 };

struct Chunk {
  std::uint64_t offset = 0;  ///< in the file
  std::uint32_t events = 0;
  Layout layout = Layout::wide;
  std::int64_t start = 0, end = 0;  ///< of its first and last event [µs]
  std::uint64_t hash = 0;
};
static_assert(sizeof(Chunk) == 40 && std::is_trivially_copyable_v<Chunk>);

/// Bits that x and y take in narrow words.
struct PixelBits {
  PixelBits(std::uint32_t width, std::uint32_t height);
  unsigned x = 16, y = 16;
  unsigned time() const { return 31 - x - y; }  ///< the remaining bits
  bool fit() const { return x + y <= 25; }      ///< in a narrow word, with 6 bits of time at least
};

std::uint64_t hash(std::span<const std::byte> bytes);

/// Size of a chunk [bytes].
std::size_t packed_size(Layout layout, std::size_t events);

/// Packs as narrow words if possible. Precondition: 1 to kChunkEvents events in time order, within kMaxSpan.
Layout pack(std::span<const Event> events, const PixelBits& bits, std::vector<std::byte>& bytes);

/// Precondition: `bytes` has packed_size(chunk) bytes; out.size() == chunk.events.
void unpack(std::span<const std::byte> bytes, const Chunk& chunk, const PixelBits& bits, std::span<Event> out);

}  // namespace evbench::native
