#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/events/event.hpp"
#include "core/events/faults.hpp"

namespace evbench {

/// Decodes a stream of bytes, passed in parts, into events. Whatever the bytes are, a decoder neither crashes nor
/// allocates: bytes that make no sense are a fault.
class EventDecoder {
 public:
  /// Most events of one record: with less room a decoder makes no progress.
  static constexpr std::size_t kMostOfRecord = 32;

  struct Progress {
    std::size_t bytes = 0, events = 0;
  };

  virtual ~EventDecoder() = default;

  /// Decodes the whole records at the beginning of `in` while `out` has room for kMostOfRecord. Pass the rest of `in`
  /// again, followed by more bytes. `offset`: position of `in` in the stream, for messages.
  virtual Progress decode(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out,
                          Faults& faults) = 0;

  /// Decodes what decode() has left at the end of the stream; returns the number of events. `out` has room for
  /// kMostOfRecord. A rest is a fault where records have a fixed length.
  virtual std::size_t finish(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out, Faults& faults);

  /// The next bytes are the beginning of the stream.
  virtual void reset() = 0;
};

/// Appends the events of a packet, which consists of whole records.
void decode_packet(EventDecoder& decoder, std::span<const std::byte> packet, std::vector<Event>& events,
                   Faults& faults);

}  // namespace evbench
