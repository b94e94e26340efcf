#include "core/events/es/es_decoder.hpp"

#include "core/events/bytes/bytes.hpp"

namespace evbench {

EventDecoder::Progress EsDecoder::decode(std::span<const std::byte> in, std::uint64_t, std::span<Event> out, Faults&) {
  return kind_ == Kind::dvs ? decode_as<Kind::dvs>(in, out) : decode_as<Kind::atis>(in, out);
}

template <EsDecoder::Kind kind>
EventDecoder::Progress EsDecoder::decode_as(std::span<const std::byte> in, std::span<Event> out) {
  // The upper bits of the first byte are a time difference, the lower ones flags. The longest difference is no event
  // but overflows: in ATIS streams as many as the flags say, in DVS streams one or, with flag 0, none (a reset).
  constexpr int kFlagBits = kind == Kind::dvs ? 1 : 2;
  constexpr std::uint32_t kFlags = (1u << kFlagBits) - 1, kLongest = 0xFFu >> kFlagBits;
  constexpr std::size_t kRecord = 5;
  std::int64_t time = time_;
  const std::byte* at = in.data();
  const std::byte* const end = in.data() + in.size();
  Event* event = out.data();
  const Event* const last = out.data() + out.size();
  while (at < end && event < last) {
    const auto first = static_cast<std::uint32_t>(*at), difference = first >> kFlagBits, flags = first & kFlags;
    if (difference == kLongest) [[unlikely]] {
      time += std::int64_t{kLongest} * flags;
      ++at;
      continue;
    }
    if (end - at < static_cast<std::ptrdiff_t>(kRecord)) break;
    time += difference;
    const bool on = (flags >> (kFlagBits - 1)) != 0;
    const auto y = static_cast<std::uint16_t>(top_ - load<std::uint16_t>(at + 3));
    *event = {time, load<std::uint16_t>(at + 1), y, on};
    event += kind == Kind::dvs || (flags & 1) == 0;
    at += kRecord;
  }
  time_ = time;
  return {static_cast<std::size_t>(at - in.data()), static_cast<std::size_t>(event - out.data())};
}

}  // namespace evbench
