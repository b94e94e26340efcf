#include "core/events/prophesee/evt2_decoder.hpp"

#include "core/events/bytes/bytes.hpp"
#include "core/events/bytes/fault_count.hpp"

namespace evbench {
namespace {

enum Type : std::uint32_t { kOff = 0x0, kOn = 0x1, kTimeHigh = 0x8, kTrigger = 0xA, kOthers = 0xE, kContinued = 0xF };

}  // namespace

EventDecoder::Progress Evt2Decoder::decode(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out,
                                           Faults& faults) {
  constexpr std::size_t kWord = 4;
  FaultCount unknown, early;
  const std::byte* at = in.data();
  const std::byte* const end = in.data() + in.size() / kWord * kWord;
  const auto position = [&] { return offset + static_cast<std::uint64_t>(at - in.data()); };
  Event* event = out.data();
  const Event* const last = out.data() + out.size();
  for (; at < end && event < last; at += kWord) {
    const std::uint32_t word = load<std::uint32_t>(at), type = word >> 28;
    if (type <= kOn) {
      *event = {time_ | ((word >> 22) & 0x3F), static_cast<std::uint16_t>((word >> 11) & 0x7FF),
                static_cast<std::uint16_t>(word & 0x7FF), type == kOn};
      event += has_time_;
      if (!has_time_) early.add(position());
    } else if (type == kTimeHigh) {
      time_ = high_.update(word & 0xFFFFFFF, position()) << 6;
      has_time_ = true;
    } else if (type != kTrigger && type != kOthers && type != kContinued) {
      unknown.add(position());
    }
  }
  high_.report(faults);
  early.report(faults, "events before the first time");
  unknown.report(faults, "words of unknown type");
  return {static_cast<std::size_t>(at - in.data()), static_cast<std::size_t>(event - out.data())};
}

}  // namespace evbench
