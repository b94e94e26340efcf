#include "frontends/haste/tracking/tracker_set.hpp"

#include <algorithm>
#include <bit>

namespace evbench::haste {

namespace {

constexpr std::size_t kBits = 64;  // of a word

}  // namespace

TrackerSet::TrackerSet(int width, int height)
    : width_(width),
      height_(height),
      columns_((width >> kCellBits) + 1),
      rows_((height >> kCellBits) + 1),
      cells_(index(columns_ * rows_)) {}

template <class CellChange>
void TrackerSet::for_cells_around(const Centre& centre, CellChange change) {
  const auto cell = [](int pixel, int count) { return std::clamp(pixel >> kCellBits, 0, count - 1); };
  constexpr int kFar = kPatchRadius - 1;  // the farthest whole pixel in range
  // Beyond the sensor there are no events: a cell at its border that is not in range does no harm.
  const int left = cell(centre.x - kFar, columns_), right = cell(centre.x + kFar, columns_);
  const int top = cell(centre.y - kFar, rows_), bottom = cell(centre.y + kFar, rows_);
  for (int row = top; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) change(cells_[index(row * columns_ + column) * words_]);
  }
}

void TrackerSet::enter(std::size_t slot, const GridState& at) {
  centres_[slot] = {at.x, at.y};
  for_cells_around(centres_[slot], [&](std::uint64_t& first) { (&first)[slot / kBits] |= 1ULL << slot % kBits; });
}

void TrackerSet::leave(std::size_t slot) {
  for_cells_around(centres_[slot], [&](std::uint64_t& first) { (&first)[slot / kBits] &= ~(1ULL << slot % kBits); });
}

/// Room for 64 more slots.
void TrackerSet::grow() {
  std::vector<std::uint64_t> wider(cells_.size() / words_ * (words_ + 1));
  for (std::size_t i = 0; i < cells_.size(); ++i) wider[i / words_ * (words_ + 1) + i % words_] = cells_[i];
  cells_ = std::move(wider);
  ++words_;
}

std::int64_t TrackerSet::add(Tracker tracker) {
  const auto free = std::ranges::find_if(slots_, [](const Slot& slot) { return !slot.tracker; });
  const auto slot = static_cast<std::size_t>(free - slots_.begin());
  if (free == slots_.end()) {
    slots_.emplace_back();
    centres_.emplace_back();
    if (slots_.size() > kBits * words_) grow();
  }
  slots_[slot] = {std::make_unique<Tracker>(std::move(tracker)), next_id_};
  slots_by_id_[next_id_] = slot;
  enter(slot, slots_[slot].tracker->grid_state());
  return next_id_++;
}

void TrackerSet::remove(std::int64_t id) {
  const std::size_t slot = slots_by_id_.at(id);
  leave(slot);
  slots_[slot] = {};
  slots_by_id_.erase(id);
}

void TrackerSet::move_by(std::int64_t id, const Vector2& translation, double angle) {
  const std::size_t slot = slots_by_id_.at(id);
  leave(slot);
  slots_[slot].tracker->move_by(translation, angle);
  enter(slot, slots_[slot].tracker->grid_state());
}

std::vector<std::int64_t> TrackerSet::ids() const {
  std::vector<std::int64_t> result;
  for (const Slot& slot : slots_) {
    if (slot.tracker) result.push_back(slot.id);
  }
  std::ranges::sort(result);
  return result;
}

void TrackerSet::push(std::span<const Event> events, std::vector<Change>& changes) {
  for (const Event& event : events) {
    if (event.x >= width_ || event.y >= height_) continue;
    const std::size_t cell = (index(event.y >> kCellBits) * index(columns_) + index(event.x >> kCellBits)) * words_;
    for (std::size_t word = 0; word < words_; ++word) {
      for (std::uint64_t near = cells_[cell + word]; near != 0; near &= near - 1) {
        const std::size_t slot = kBits * word + static_cast<std::size_t>(std::countr_zero(near));
        const auto [x, y] = centres_[slot];
        if (in_range(event.x - x, event.y - y)) push(event, slot, changes);
      }
    }
  }
}

void TrackerSet::push(const Event& event, std::size_t slot, std::vector<Change>& changes) {
  Tracker& tracker = *slots_[slot].tracker;
  const Tracker::Update update = tracker.push(event);
  if (update != Tracker::Update::changed && update != Tracker::Update::started) return;
  changes.push_back(tracker.change());
  changes.back().tracker = slots_[slot].id;
  leave(slot);
  enter(slot, tracker.grid_state());
}

}  // namespace evbench::haste
