#include "frontends/haste/tracking/tracker_set.hpp"

#include <algorithm>
#include <bit>

namespace evbench::haste {

namespace {

constexpr std::size_t kBits = 64;     // of a word
constexpr int kCellBits = 2;          // cells of 4 × 4 px
constexpr std::size_t kBatch = 4096;  // events
constexpr int kSlack = 2;             // [px] that a tracker may go in a batch before it has to look at all the rest
constexpr int kNear = kPatchRadius + kSlack;

constexpr int square(int x, int y) { return x * x + y * y; }

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
  // A tracker far outside is known to the cells at the border, which does no harm.
  const int left = cell(centre.x - kNear, columns_), right = cell(centre.x + kNear, columns_);
  const int top = cell(centre.y - kNear, rows_), bottom = cell(centre.y + kNear, rows_);
  for (int row = top; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) change(cells_[index(row * columns_ + column) * words_]);
  }
}

void TrackerSet::enter(std::size_t slot) {
  const GridState& grid = slots_[slot].tracker->grid_state();
  centres_[slot] = {grid.x, grid.y};
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
    slots_.emplace_back().near.resize(kBatch);
    centres_.emplace_back();
    if (slots_.size() > kBits * words_) grow();
  }
  slots_[slot].tracker = std::make_unique<Tracker>(std::move(tracker));
  slots_[slot].id = next_id_;
  slots_by_id_[next_id_] = slot;
  enter(slot);
  return next_id_++;
}

void TrackerSet::remove(std::int64_t id) {
  const std::size_t slot = slots_by_id_.at(id);
  leave(slot);
  slots_[slot].tracker.reset();
  slots_by_id_.erase(id);
}

void TrackerSet::move_by(std::int64_t id, const Vector2& translation, double angle) {
  const std::size_t slot = slots_by_id_.at(id);
  leave(slot);
  slots_[slot].tracker->move_by(translation, angle);
  enter(slot);
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
  for (std::size_t i = 0; i < events.size(); i += kBatch) {
    push_batch(events.subspan(i, std::min(kBatch, events.size() - i)), changes);
  }
}

void TrackerSet::push_batch(std::span<const Event> events, std::vector<Change>& changes) {
  sort_by_trackers(events);
  found_.clear();
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
    if (slots_[slot].near_count > 0) track(slot, events);
  }
  std::ranges::sort(found_, {}, [](const Found& found) { return std::pair(found.event, found.change.tracker); });
  for (const Found& found : found_) changes.push_back(found.change);
}

void TrackerSet::sort_by_trackers(std::span<const Event> events) {
  for (Slot& slot : slots_) slot.near_count = 0;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const Event& event = events[i];
    if (event.x >= width_ || event.y >= height_) continue;
    const std::size_t cell = (index(event.y >> kCellBits) * index(columns_) + index(event.x >> kCellBits)) * words_;
    for (std::size_t word = 0; word < words_; ++word) {
      for (std::uint64_t near = cells_[cell + word]; near != 0; near &= near - 1) {
        const std::size_t slot = kBits * word + static_cast<std::size_t>(std::countr_zero(near));
        const auto [x, y] = centres_[slot];
        // Without a branch, which could not be predicted.
        Slot& candidate = slots_[slot];
        candidate.near[candidate.near_count] = static_cast<std::uint16_t>(i);
        candidate.near_count += square(event.x - x, event.y - y) < kNear * kNear;
      }
    }
  }
}

/// Hands its events to a tracker.
void TrackerSet::track(std::size_t slot, std::span<const Event> events) {
  Tracker& tracker = *slots_[slot].tracker;
  const Centre centre = centres_[slot];
  bool moved = false, far = false;
  const auto push = [&](std::size_t i) {
    const Tracker::Update update = tracker.push(events[i]);
    if (update != Tracker::Update::changed && update != Tracker::Update::started) return;
    found_.push_back({i, tracker.change()});
    found_.back().change.tracker = slots_[slot].id;
    const GridState& grid = tracker.grid_state();
    moved = true;
    far = square(grid.x - centre.x, grid.y - centre.y) > kSlack * kSlack;
  };
  for (const std::size_t i : std::span(slots_[slot].near).first(slots_[slot].near_count)) {
    push(i);
    if (!far) continue;
    for (std::size_t rest = i + 1; rest < events.size(); ++rest) {
      if (events[rest].x < width_ && events[rest].y < height_) push(rest);
    }
    break;
  }
  if (!moved) return;
  leave(slot);
  enter(slot);
}

}  // namespace evbench::haste
