#include "core/events/prophesee/evt3_decoder.hpp"

#include <algorithm>
#include <bit>

#include "core/events/bytes/bytes.hpp"
#include "core/events/bytes/fault_count.hpp"

namespace evbench {
namespace {

enum Type : std::uint32_t {
  kRow = 0x0,
  kEvent = 0x2,
  kVectorBase = 0x3,
  kVector12 = 0x4,
  kVector8 = 0x5,
  kTimeLow = 0x6,
  kContinued4 = 0x7,
  kTimeHigh = 0x8,
  kTrigger = 0xA,
  kOthers = 0xE,
  kContinued12 = 0xF,
};

constexpr std::uint32_t set(std::initializer_list<Type> types) {
  std::uint32_t bits = 0;
  for (const Type type : types) bits |= 1u << type;
  return bits;
}

constexpr std::uint32_t kFrequent = set({kRow, kEvent, kTimeLow});
constexpr std::uint32_t kKnown =
    kFrequent | set({kVectorBase, kVector12, kVector8, kContinued4, kTimeHigh, kTrigger, kOthers, kContinued12});
constexpr std::uint32_t kWithEvents = set({kEvent, kVector12, kVector8});
constexpr std::size_t kWord = 2;
constexpr std::int64_t kLowMask = 0xFFF;

std::uint32_t coordinate(std::uint32_t word) { return word & 0x7FF; }
bool polarity(std::uint32_t word) { return (word & 0x800) != 0; }

}  // namespace

void Evt3Decoder::set_time_high(std::uint32_t value, std::uint64_t place) {
  const std::int64_t high = high_.update(value, place) << 12;
  // The low bits come with the next word; until then a new high begins at its zero.
  if (high != (time_ & ~kLowMask)) time_ = high;
  has_time_ = true;
}

/// Skips words until time and row are known.
std::size_t Evt3Decoder::find_state(std::span<const std::byte> in, std::uint64_t offset, Faults& faults) {
  FaultCount early;
  std::size_t at = 0;
  for (; at + kWord <= in.size() && !(has_time_ && has_row_); at += kWord) {
    const std::uint32_t word = load<std::uint16_t>(in.data() + at), type = word >> 12;
    if (type == kTimeHigh) set_time_high(word & 0xFFF, offset + at);
    if (type == kTimeLow && has_time_) time_ = (time_ & ~kLowMask) | (word & 0xFFF);
    if (type == kRow) {
      y_ = static_cast<std::uint16_t>(coordinate(word));
      has_row_ = true;
    }
    if ((kWithEvents >> type) & 1) early.add(offset + at);
  }
  early.report(faults, "words with events before the first time and row");
  return at;
}

EventDecoder::Progress Evt3Decoder::decode(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out,
                                           Faults& faults) {
  constexpr std::size_t kMostOfWord = 12;
  constexpr std::uint32_t kFarRight = 0x7000;  // an endless vector stays outside of every sensor
  const std::size_t begin = has_time_ && has_row_ ? 0 : find_state(in, offset, faults);
  FaultCount unknown;
  const std::byte* at = in.data() + begin;
  const std::byte* const end = in.data() + in.size() / kWord * kWord;
  const auto place = [&] { return offset + static_cast<std::uint64_t>(at - in.data()); };
  Event* event = out.data();
  const Event* const last = out.data() + (out.size() < kMostOfWord ? 0 : out.size() - kMostOfWord + 1);
  std::int64_t time = time_;
  std::uint16_t y = y_;
  for (; at < end && event < last; at += kWord) {
    const std::uint32_t word = load<std::uint16_t>(at), type = word >> 12;
    if ((kFrequent >> type) & 1) {  // without branches, as these alternate unpredictably
      y = type == kRow ? static_cast<std::uint16_t>(coordinate(word)) : y;
      time = type == kTimeLow ? (time & ~kLowMask) | (word & 0xFFF) : time;
      *event = {time, static_cast<std::uint16_t>(coordinate(word)), y, polarity(word)};
      event += type == kEvent;
    } else if (type == kVector12 || type == kVector8) {
      for (std::uint32_t valid = word & (type == kVector12 ? 0xFFF : 0xFF); valid != 0; valid &= valid - 1) {
        const auto x = vector_.x + static_cast<std::uint32_t>(std::countr_zero(valid));
        *event++ = {time, static_cast<std::uint16_t>(x), y, vector_.on};
      }
      vector_.x = std::min(vector_.x + (type == kVector12 ? 12 : 8), kFarRight);
    } else if (type == kVectorBase) {
      vector_ = {coordinate(word), polarity(word)};
    } else if (type == kTimeHigh) {
      time_ = time;
      set_time_high(word & 0xFFF, place());
      time = time_;
    } else if (((kKnown >> type) & 1) == 0) {
      unknown.add(place());
    }
  }
  time_ = time;
  y_ = y;
  high_.report(faults);
  unknown.report(faults, "words of unknown type");
  return {static_cast<std::size_t>(at - in.data()), static_cast<std::size_t>(event - out.data())};
}

}  // namespace evbench
