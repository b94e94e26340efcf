#include "core/events/prophesee/dat_decoder.hpp"

#include <algorithm>

#include "core/events/bytes/bytes.hpp"

namespace evbench {

EventDecoder::Progress DatDecoder::decode(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out,
                                          Faults& faults) {
  const Progress progress =
      version_ == Version::one ? decode_as<9, 8>(in, offset, out) : decode_as<14, 14>(in, offset, out);
  time_.report(faults);
  return progress;
}

template <int x_bits, int y_bits>
EventDecoder::Progress DatDecoder::decode_as(std::span<const std::byte> in, std::uint64_t offset,
                                             std::span<Event> out) {
  constexpr std::size_t kRecord = 8;
  const std::size_t count = std::min(in.size() / kRecord, out.size());
  for (std::size_t i = 0; i < count; ++i) {
    const auto time = load<std::uint32_t>(in.data() + i * kRecord);
    const auto word = load<std::uint32_t>(in.data() + i * kRecord + 4);
    out[i] = {time_.update(time, offset + i * kRecord), static_cast<std::uint16_t>(word & ((1u << x_bits) - 1)),
              static_cast<std::uint16_t>((word >> x_bits) & ((1u << y_bits) - 1)),
              ((word >> (x_bits + y_bits)) & 1) != 0};
  }
  return {count * kRecord, count};
}

}  // namespace evbench
