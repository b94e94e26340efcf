#include "core/events/bytes/event_decoder.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace evbench {

std::size_t EventDecoder::finish(std::span<const std::byte> in, std::uint64_t offset, std::span<Event>,
                                 Faults& faults) {
  if (!in.empty()) faults.add("truncated record at the end", fmt::format("byte {}", offset));
  return 0;
}

void decode_packet(EventDecoder& decoder, std::span<const std::byte> packet, std::vector<Event>& events,
                   Faults& faults) {
  constexpr std::size_t kBytes = 4;  // of an event, usually: room for more than there are would be filled in vain
  std::size_t done = 0, count = events.size();
  while (true) {
    events.resize(count + std::max(EventDecoder::kMostOfRecord, (packet.size() - done) / kBytes));
    const auto progress = decoder.decode(packet.subspan(done), done, std::span(events).subspan(count), faults);
    done += progress.bytes;
    count += progress.events;
    if (progress.bytes == 0) break;
  }
  events.resize(count);
  if (done < packet.size()) faults.add("truncated record at the end of a packet", fmt::format("byte {}", done));
}

}  // namespace evbench
