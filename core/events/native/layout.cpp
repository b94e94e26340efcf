#include "core/events/native/layout.hpp"

#include <algorithm>
#include <cstring>

#include "core/events/bytes/event_words.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace evbench::native {
namespace {

constexpr unsigned kWideBits = 16;

template <class Word>
Word load(const std::byte* from) {
  Word word;
  std::memcpy(&word, from, sizeof word);
  return word;
}

template <class Word>
void append(Word word, std::vector<std::byte>& bytes) {
  const auto* const first = reinterpret_cast<const std::byte*>(&word);
  bytes.insert(bytes.end(), first, first + sizeof word);
}

template <class Word>
Word pack_word(const Event& event, std::int64_t base, unsigned x_bits, unsigned y_bits) {
  Word word = static_cast<Word>(event.t - base);
  word = static_cast<Word>(word << y_bits) | event.y;
  word = static_cast<Word>(word << x_bits) | event.x;
  return static_cast<Word>(word << 1) | static_cast<Word>(event.on);
}

/// Unpacks `count` words into events.
template <class Word>
void unpack_words(const std::byte* words, std::size_t count, std::int64_t base, unsigned x_bits, unsigned y_bits,
                  Event* out) {
  const std::uint64_t x_mask = (std::uint64_t{1} << x_bits) - 1, y_mask = (std::uint64_t{1} << y_bits) - 1;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t word = load<Word>(words + i * sizeof(Word));
    const std::uint64_t t = static_cast<std::uint64_t>(base) + (word >> (1 + x_bits + y_bits));
    store_event(t, (word >> 1 & x_mask) | (word >> (1 + x_bits) & y_mask) << 16 | (word & 1) << 32, out + i);
  }
}

std::size_t group_count(std::size_t events) { return (events + kGroupEvents - 1) / kGroupEvents; }

bool fits_narrow(std::span<const Event> events, const PixelBits& bits) {
  if (!bits.fit()) return false;
  for (std::size_t i = 0; i < events.size(); i += kGroupEvents) {
    const std::size_t last = std::min(i + kGroupEvents, events.size()) - 1;
    if ((events[last].t - events[i].t) >> bits.time() != 0) return false;
  }
  return true;
}

}  // namespace

PixelBits::PixelBits(std::uint32_t width, std::uint32_t height) {
  if (width > 0) x = static_cast<unsigned>(std::bit_width(width - 1));
  if (height > 0) y = static_cast<unsigned>(std::bit_width(height - 1));
}

std::uint64_t hash(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

std::size_t packed_size(Layout layout, std::size_t events) {
  return layout == Layout::wide ? events * sizeof(std::uint64_t)
                                : (events + group_count(events)) * sizeof(std::uint32_t);
}

Layout pack(std::span<const Event> events, const PixelBits& bits, std::vector<std::byte>& bytes) {
  bytes.clear();
  const std::int64_t start = events.front().t;
  if (!fits_narrow(events, bits)) {
    for (const Event& event : events) append(pack_word<std::uint64_t>(event, start, kWideBits, kWideBits), bytes);
    return Layout::wide;
  }
  for (std::size_t i = 0; i < events.size(); i += kGroupEvents) {
    append(static_cast<std::uint32_t>(events[i].t - start), bytes);
  }
  for (std::size_t i = 0; i < events.size(); ++i) {
    const std::int64_t base = events[i / kGroupEvents * kGroupEvents].t;
    append(pack_word<std::uint32_t>(events[i], base, bits.x, bits.y), bytes);
  }
  return Layout::narrow;
}

void unpack(std::span<const std::byte> bytes, const Chunk& chunk, const PixelBits& bits, std::span<Event> out) {
  if (chunk.layout == Layout::wide) {
    unpack_words<std::uint64_t>(bytes.data(), out.size(), chunk.start, kWideBits, kWideBits, out.data());
    return;
  }
  const std::byte* const words = bytes.data() + group_count(out.size()) * sizeof(std::uint32_t);
  for (std::size_t i = 0; i < out.size(); i += kGroupEvents) {
    const std::int64_t base =
        chunk.start + load<std::uint32_t>(bytes.data() + i / kGroupEvents * sizeof(std::uint32_t));
    unpack_words<std::uint32_t>(words + i * sizeof(std::uint32_t), std::min(kGroupEvents, out.size() - i), base, bits.x,
                                bits.y, out.data() + i);
  }
}

}  // namespace evbench::native
