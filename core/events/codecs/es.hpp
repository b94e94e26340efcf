#pragma once

#include "core/events/codecs/event_decoder.hpp"

namespace evbench {

/// Event Stream version 2: five bytes an event, times as differences, longer differences by overflow bytes.
/// https://github.com/neuromorphic-paris/event_stream
class EsDecoder final : public EventDecoder {
 public:
  /// ATIS streams hold exposure measurements (threshold crossings) between the events, which are passed over.
  enum class Kind { dvs, atis };

  explicit EsDecoder(Kind kind) : kind_(kind) {}
  Progress decode(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out, Faults& faults) override;
  void reset() override { time_ = 0; }

 private:
  template <Kind kind>
  Progress decode_as(std::span<const std::byte> in, std::span<Event> out);

  Kind kind_;
  std::int64_t time_ = 0;  ///< [µs]
};

}  // namespace evbench
