#include "frontends/haste/tracking/tracker_set.hpp"

#include <algorithm>
#include <utility>

#include "core/support/index.hpp"
#include "core/support/parallel.hpp"

namespace evbench::haste {

TrackerSet::TrackerSet(int width, int height, int threads) {
  const int groups = at_most_processors(threads);
  for (int i = 0; i < groups; ++i) groups_.emplace_back(width, height);
}

std::int64_t TrackerSet::add(Tracker tracker) {
  const auto smallest = std::ranges::min_element(groups_, {}, &TrackerGroup::size);
  const std::size_t slot = smallest->add(next_id_, std::move(tracker));
  places_[next_id_] = {static_cast<std::size_t>(smallest - groups_.begin()), slot};
  return next_id_++;
}

void TrackerSet::remove(std::int64_t id) {
  const auto [group, slot] = places_.at(id);
  groups_[group].remove(slot);
  places_.erase(id);
}

const Tracker& TrackerSet::tracker(std::int64_t id) const {
  const auto [group, slot] = places_.at(id);
  return groups_[group].tracker(slot);
}

std::vector<std::int64_t> TrackerSet::ids() const {
  std::vector<std::int64_t> ids;
  for (const auto& [id, place] : places_) ids.push_back(id);
  return ids;
}

void TrackerSet::push(std::span<const Event> events, std::vector<Change>& changes) {
  const auto groups = static_cast<int>(groups_.size());
  parallel_for(groups, groups, [&](int group) { groups_[index(group)].push(events); });
  found_.clear();
  for (const TrackerGroup& group : groups_) found_.insert(found_.end(), group.found().begin(), group.found().end());
  std::ranges::sort(found_, {}, [](const auto& found) { return std::pair(found.event, found.change.tracker); });
  for (const auto& found : found_) changes.push_back(found.change);
}

}  // namespace evbench::haste
