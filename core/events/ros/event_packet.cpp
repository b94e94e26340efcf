#include "core/events/ros/event_packet.hpp"

#include <fmt/format.h>

#include "core/events/bytes/bytes.hpp"
#include "core/events/bytes/wrapping_counter.hpp"

namespace evbench {
namespace {

/// libcaer's polarity event: a word of polarity, valid bit and pixel, then a word of time.
void decode_libcaer(std::span<const std::byte> bytes, std::int64_t base, const std::string& where,
                    std::vector<Event>& events, Faults& faults) {
  constexpr std::size_t kSize = 8;
  WrappingCounter counter{31, 1};
  std::int64_t invalid = 0;
  for (std::uint64_t at = 0; bytes.size() >= kSize; bytes = bytes.subspan(kSize), at += kSize) {
    const auto word = load<std::uint32_t>(bytes.data());
    const std::int64_t time = counter.update(load<std::uint32_t>(bytes.data() + 4) & 0x7FFF'FFFF, at);
    if ((word & 1) == 0) {
      ++invalid;
      continue;
    }
    events.push_back({base + time, static_cast<std::uint16_t>(word >> 17),
                      static_cast<std::uint16_t>((word >> 2) & 0x7FFF), (word & 2) != 0});
  }
  counter.report(faults, (where + ", byte").c_str());
  if (invalid > 0) faults.add("events that the camera marked as invalid", where, invalid);
  if (!bytes.empty()) faults.add("packets that end within an event", where);
}

/// The highest four bits of a word are its type.
void decode_libcaer_cmp(std::span<const std::byte> bytes, std::int64_t base, const std::string& where,
                        std::vector<Event>& events, Faults& faults) {
  WrappingCounter counter{12, 4096};
  std::int64_t high = 0, low = 0, unknown = 0;
  std::uint16_t x = 0, y = 0;
  bool on = false;
  for (std::uint64_t at = 0; bytes.size() >= 2; bytes = bytes.subspan(2), at += 2) {
    const auto word = load<std::uint16_t>(bytes.data());
    switch (word >> 12) {
      case 0: high = counter.update(word & 0xFFF, at) << 12; break;
      case 1: low = word & 0xFFF; break;
      case 2: x = word & 0x7FF; break;
      case 3:
        events.push_back({base + high + low, x, static_cast<std::uint16_t>(word & 0x7FF), (word & 0x800) != 0});
        break;
      case 4:
        y = word & 0x7FF;
        on = (word & 0x800) != 0;
        break;
      case 5:
        for (int i = 0; i < 8; ++i) {
          if ((word >> i & 1) != 0) events.push_back({base + high + low, x, static_cast<std::uint16_t>(y + i), on});
        }
        y = static_cast<std::uint16_t>(y + 8);
        break;
      default: ++unknown;
    }
  }
  counter.report(faults, (where + ", byte").c_str());
  if (unknown > 0) faults.add("unknown words of libcaer_cmp", where, unknown);
  if (!bytes.empty()) faults.add("packets that end within an event", where);
}

}  // namespace

void EventPacketDecoder::decode(const Packet& packet, const std::string& where, std::vector<Event>& events,
                                Faults& faults) {
  const auto base = static_cast<std::int64_t>(packet.time_base / 1000);
  if (packet.encoding == "evt3") {
    decode_packet(evt3_, packet.bytes, events, faults);
  } else if (packet.encoding == "libcaer") {
    decode_libcaer(packet.bytes, base, where, events, faults);
  } else if (packet.encoding == "libcaer_cmp") {
    decode_libcaer_cmp(packet.bytes, base, where, events, faults);
  } else {
    faults.add(fmt::format("packets of encoding '{}', which evbench doesn't read", packet.encoding.substr(0, 32)),
               where);
  }
}

}  // namespace evbench
