#pragma once

#include "core/events/bytes/event_decoder.hpp"
#include "core/events/bytes/wrapping_counter.hpp"

namespace evbench {

/// Prophesee's EVT 2.0: 32-bit words, an event each but for the high bits of time. The 34-bit time (4.8 h) is
/// unwrapped. Events before the first time are faults; triggers and vendors' words are skipped.
/// https://docs.prophesee.ai/stable/data/encoding_formats/evt2.html
class Evt2Decoder final : public EventDecoder {
 public:
  Progress decode(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out, Faults& faults) override;
  void reset() override { *this = {}; }

 private:
  WrappingCounter high_{28, 64};
  std::int64_t time_ = 0;  ///< of the high bits [µs]
  bool has_time_ = false;
};

}  // namespace evbench
