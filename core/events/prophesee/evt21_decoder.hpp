#pragma once

#include "core/events/bytes/event_decoder.hpp"
#include "core/events/bytes/wrapping_counter.hpp"

namespace evbench {

/// Prophesee's EVT 2.1: 64-bit words, each up to 32 events of one row, time and polarity. Otherwise like EVT 2.0.
/// https://docs.prophesee.ai/stable/data/encoding_formats/evt21.html
class Evt21Decoder final : public EventDecoder {
 public:
  /// Order of a word's 32-bit halves: cameras of the first generation ("endianness=legacy") send the half with the type
  /// first.
  enum class Order { low_half_first, high_half_first };

  explicit Evt21Decoder(Order order) : order_(order) {}
  Progress decode(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out, Faults& faults) override;
  void reset() override { *this = Evt21Decoder(order_); }

 private:
  Order order_;
  WrappingCounter high_{28, 64};
  std::int64_t time_ = 0;  ///< of the high bits [µs]
  bool has_time_ = false;
};

}  // namespace evbench
