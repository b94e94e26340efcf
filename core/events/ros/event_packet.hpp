#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/events/event.hpp"
#include "core/events/faults.hpp"
#include "core/events/prophesee/evt3_decoder.hpp"

namespace evbench {

/// The payload of event_camera_msgs/EventPacket. Encodings:
///   evt3         Prophesee's words; times are the sensor's own and continue from packet to packet
///   libcaer      8 bytes an event, as libcaer has them; times are time_base and 31 bits of µs
///   libcaer_cmp  16-bit words like EVT 3 with rows and columns exchanged; times are time_base and 24 bits of µs
/// Others (mono, trigger) are counted as faults and left out.
class EventPacketDecoder {
 public:
  struct Packet {
    std::span<const std::byte> bytes;
    std::string encoding;
    std::uint64_t time_base = 0;  ///< [ns]
  };

  /// Appends the packet's events [µs]. `where`: for messages.
  void decode(const Packet& packet, const std::string& where, std::vector<Event>& events, Faults& faults);
  /// The next packet doesn't follow the last one.
  void reset() { evt3_.reset(); }

 private:
  Evt3Decoder evt3_;
};

}  // namespace evbench
