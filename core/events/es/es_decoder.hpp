#pragma once

#include "core/events/bytes/event_decoder.hpp"

namespace evbench {

/// Event Stream version 2: five bytes an event, times as differences, longer differences by overflow bytes.
/// https://github.com/neuromorphic-paris/event_stream
/// Its rows are numbered from the sensor's bottom; events have them from the top, as everywhere.
class EsDecoder final : public EventDecoder {
 public:
  /// ATIS streams hold exposure measurements (threshold crossings) between the events, which are passed over.
  enum class Kind { dvs, atis };

  /// `height` of the sensor [px]; events below row 0 get one of at least `height`.
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
