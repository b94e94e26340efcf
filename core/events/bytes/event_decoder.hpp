#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/events/event.hpp"
#include "core/events/faults.hpp"

namespace evbench {

/// Turns a stream of bytes, given piece by piece, into events. Whatever the bytes are, a decoder neither crashes nor
/// allocates: what makes no sense is a fault.
class EventDecoder {
 public:
  /// Events that one record may hold at most: there is no progress with less room.
  static constexpr std::size_t kMostOfRecord = 32;

  struct Progress {
    std::size_t bytes = 0, events = 0;
  };

  virtual ~EventDecoder() = default;

  /// Decodes the whole records at the beginning of `in` as long as there is room for kMostOfRecord in `out`. What it
  /// leaves of `in` is to be given again, with more behind it. `offset`: of `in` in the stream, for messages.
  virtual Progress decode(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out,
                          Faults& faults) = 0;

  /// At the end of the stream: what decode() has left, with room for kMostOfRecord; returns the number of events. A
  /// fault, where records have a fixed length.
  virtual std::size_t finish(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out, Faults& faults);

  /// What follows is the beginning of the stream.
  virtual void reset() = 0;
};

/// Appends the events of a packet, all of whose records are whole.
void decode_packet(EventDecoder& decoder, std::span<const std::byte> packet, std::vector<Event>& events,
                   Faults& faults);

}  // namespace evbench
