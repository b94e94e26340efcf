#pragma once

#include "core/events/bytes/event_decoder.hpp"
#include "core/events/bytes/wrapping_counter.hpp"

namespace evbench {

/// Records of Prophesee's DAT files: 32 bits of time [µs], 32 bits of pixel and polarity. The 32-bit time (71 min) is
/// unwrapped.
class DatDecoder final : public EventDecoder {
 public:
  /// Bits of x, y, polarity: 9, 8, 1 in version 1 (ATIS), 14, 14, 4 in version 2.
  enum class Version { one, two };

  explicit DatDecoder(Version version) : version_(version) {}
  Progress decode(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out, Faults& faults) override;
  void reset() override { *this = DatDecoder(version_); }

 private:
  template <int x_bits, int y_bits>
  Progress decode_as(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out);

  Version version_;
  WrappingCounter time_{32, 1};
};

}  // namespace evbench
