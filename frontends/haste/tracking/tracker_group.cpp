#include "frontends/haste/tracking/tracker_group.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/support/index.hpp"

namespace evbench::haste {

namespace {

constexpr std::size_t kBits = 64;     // of a word
constexpr int kCellBits = 2;          // cells of 4 × 4 px
constexpr std::size_t kBatch = 4096;  // events
constexpr int kSlack = 2;             // [px] that a tracker may move in a batch before it checks all remaining events
constexpr int kNear = kPatchRadius + kSlack;

constexpr int square(int x, int y) { return x * x + y * y; }

}  // namespace

TrackerGroup::TrackerGroup(int width, int height)
    : width_(width),
      height_(height),
      columns_((width >> kCellBits) + 1),
      rows_((height >> kCellBits) + 1),
      cells_(index(columns_ * rows_)) {}

template <class CellChange>
void TrackerGroup::for_cells_around(const Centre& centre, CellChange change) {
  const auto cell = [](int pixel, int count) { return std::clamp(pixel >> kCellBits, 0, count - 1); };
  // A tracker far outside is listed in the cells at the border, which does no harm.
  const int left = cell(centre.x - kNear, columns_), right = cell(centre.x + kNear, columns_);
  const int top = cell(centre.y - kNear, rows_), bottom = cell(centre.y + kNear, rows_);
  for (int row = top; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) change(cells_[index(row * columns_ + column) * words_]);
  }
}

void TrackerGroup::enter(std::size_t slot) {
  const GridState& grid = slots_[slot].tracker->grid_state();
  centres_[slot] = {grid.x, grid.y};
  for_cells_around(centres_[slot], [&](std::uint64_t& first) { (&first)[slot / kBits] |= 1ULL << slot % kBits; });
}

void TrackerGroup::leave(std::size_t slot) {
  for_cells_around(centres_[slot], [&](std::uint64_t& first) { (&first)[slot / kBits] &= ~(1ULL << slot % kBits); });
}

/// Room for 64 more slots.
void TrackerGroup::grow() {
  std::vector<std::uint64_t> wider(cells_.size() / words_ * (words_ + 1));
  for (std::size_t i = 0; i < cells_.size(); ++i) wider[i / words_ * (words_ + 1) + i % words_] = cells_[i];
  cells_ = std::move(wider);
  ++words_;
}

std::size_t TrackerGroup::add(std::int64_t id, Tracker tracker) {
  const auto free = std::ranges::find_if(slots_, [](const Slot& slot) { return !slot.tracker; });
  const auto slot = static_cast<std::size_t>(free - slots_.begin());
  if (free == slots_.end()) {
    slots_.emplace_back().near.resize(kBatch);
    centres_.emplace_back();
    if (slots_.size() > kBits * words_) grow();
  }
  slots_[slot].tracker = std::make_unique<Tracker>(std::move(tracker));
  slots_[slot].id = id;
  enter(slot);
  ++size_;
  return slot;
}

void TrackerGroup::remove(std::size_t slot) {
  leave(slot);
  slots_[slot].tracker.reset();
  --size_;
}

void TrackerGroup::push(std::span<const Event> events) {
  found_.clear();
  for (std::size_t first = 0; first < events.size(); first += kBatch) {
    const auto batch = events.subspan(first, std::min(kBatch, events.size() - first));
    sort_by_trackers(batch);
    for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
      if (slots_[slot].near_count > 0) track(slot, batch, first);
    }
  }
}

void TrackerGroup::sort_by_trackers(std::span<const Event> batch) {
  for (Slot& slot : slots_) slot.near_count = 0;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const Event& event = batch[i];
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

/// Passes a tracker its events. `first`: the index of the batch's first event among the pushed ones.
void TrackerGroup::track(std::size_t slot, std::span<const Event> batch, std::size_t first) {
  Tracker& tracker = *slots_[slot].tracker;
  const Centre centre = centres_[slot];
  bool moved = false, far = false;
  const auto push = [&](std::size_t i) {
    const Tracker::Update update = tracker.push(batch[i]);
    if (update != Tracker::Update::changed && update != Tracker::Update::started) return;
    found_.push_back({first + i, tracker.change()});
    found_.back().change.tracker = slots_[slot].id;
    const GridState& grid = tracker.grid_state();
    moved = true;
    far = square(grid.x - centre.x, grid.y - centre.y) > kSlack * kSlack;
  };
  for (const std::size_t i : std::span(slots_[slot].near).first(slots_[slot].near_count)) {
    push(i);
    if (!far) continue;
    for (std::size_t rest = i + 1; rest < batch.size(); ++rest) {
      if (batch[rest].x < width_ && batch[rest].y < height_) push(rest);
    }
    break;
  }
  if (!moved) return;
  leave(slot);
  enter(slot);
}

}  // namespace evbench::haste
