#include "core/events/prophesee/evt21_decoder.hpp"

#include <bit>

#include "core/events/bytes/bytes.hpp"
#include "core/events/bytes/fault_count.hpp"

namespace evbench {
namespace {

enum Type : std::uint32_t { kOff = 0x0, kOn = 0x1, kTimeHigh = 0x8, kTrigger = 0xA, kOthers = 0xE, kContinued = 0xF };

}  // namespace

EventDecoder::Progress Evt21Decoder::decode(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out,
                                            Faults& faults) {
  constexpr std::size_t kWord = 8, kMostOfWord = 32;
  FaultCount unknown, early;
  const std::size_t upper = order_ == Order::high_half_first ? 0 : 4, lower = 4 - upper;
  std::size_t at = 0, count = 0;
  for (; at + kWord <= in.size() && count + kMostOfWord <= out.size(); at += kWord) {
    const std::uint32_t head = load<std::uint32_t>(in.data() + at + upper), type = head >> 28;
    if (type <= kOn && has_time_) {
      const std::int64_t time = time_ | ((head >> 22) & 0x3F);
      const std::uint32_t x = (head >> 11) & 0x7FF;
      const auto y = static_cast<std::uint16_t>(head & 0x7FF);
      for (auto valid = load<std::uint32_t>(in.data() + at + lower); valid != 0; valid &= valid - 1) {
        const auto column = static_cast<std::uint16_t>(x + static_cast<std::uint32_t>(std::countr_zero(valid)));
        out[count++] = {time, column, y, type == kOn};
      }
    } else if (type <= kOn) {
      early.add(offset + at);
    } else if (type == kTimeHigh) {
      time_ = high_.update(head & 0xFFFFFFF, offset + at) << 6;
      has_time_ = true;
    } else if (type != kTrigger && type != kOthers && type != kContinued) {
      unknown.add(offset + at);
    }
  }
  high_.report(faults);
  early.report(faults, "words with events before the first time");
  unknown.report(faults, "words of unknown type");
  return {at, count};
}

}  // namespace evbench
