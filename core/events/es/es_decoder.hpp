#pragma once

#include "core/events/bytes/event_decoder.hpp"

namespace evbench {

/// Event Stream version 2: five bytes an event, times as differences, longer differences by overflow bytes. Files
/// number the rows from the bottom of the sensor; events have them from the top.
/// https://github.com/neuromorphic-paris/event_stream
class EsDecoder final : public EventDecoder {
 public:
  /// ATIS streams also have exposure measurements (threshold crossings), which are skipped.
  enum class Kind { dvs, atis };

  /// `height`: the sensor's [px]. Events below row 0 get a row of at least `height`.
  EsDecoder(Kind kind, int height) : kind_(kind), top_(static_cast<std::uint16_t>(height - 1)) {}
  Progress decode(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out, Faults& faults) override;
  void reset() override { time_ = 0; }

 private:
  template <Kind kind>
  Progress decode_as(std::span<const std::byte> in, std::span<Event> out);

  Kind kind_;
  std::uint16_t top_;      ///< the file's number of the highest row
  std::int64_t time_ = 0;  ///< [µs]
};

}  // namespace evbench
