#pragma once

#include "core/events/bytes/event_decoder.hpp"
#include "core/events/bytes/wrapping_counter.hpp"

namespace evbench {

/// Prophesee's EVT 3.0, as in RAW files and in the packets of event_camera_msgs: 16-bit words that change a state
/// (time, row, base column) or give events. The 24-bit time (16.8 s) is unwrapped. Before the first time and row are
/// known, events are faults; triggers and vendors' words are skipped.
/// https://docs.prophesee.ai/stable/data/encoding_formats/evt3.html
class Evt3Decoder final : public EventDecoder {
 public:
  Progress decode(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out, Faults& faults) override;
  void reset() override { *this = {}; }

 private:
  struct Vector {
    std::uint32_t x = 0;
    bool on = false;
  };

  std::size_t find_state(std::span<const std::byte> in, std::uint64_t offset, Faults& faults);
  void set_time_high(std::uint32_t value, std::uint64_t place);

  WrappingCounter high_{12, 4096};
  std::int64_t time_ = 0;  ///< [µs]
  std::uint16_t y_ = 0;
  Vector vector_;
  bool has_time_ = false, has_row_ = false;
};

}  // namespace evbench
