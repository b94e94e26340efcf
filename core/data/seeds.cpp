#include "core/data/seeds.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "core/data/tracks.hpp"

namespace evbench {

Seeds::Seeds(const std::string& path) {
  if (path.empty()) return;
  constexpr int kAnySize = std::numeric_limits<int>::max();
  std::set<TrackId> known;
  for (const TrackObservation& z : read_tracks(path, kAnySize, kAnySize).observations) {
    if (known.insert(z.track).second) seeds_.push_back(z);
  }
}

TrackId Seeds::next_id() const {
  TrackId id = 0;
  for (const TrackObservation& seed : seeds_) id = std::max(id, seed.track + 1);
  return id;
}

double Seeds::next() const {
  return taken_ < seeds_.size() ? seeds_[taken_].t : std::numeric_limits<double>::infinity();
}

std::span<const TrackObservation> Seeds::take(double t) {
  const std::size_t first = taken_;
  while (next() <= t) ++taken_;
  return std::span(seeds_).subspan(first, taken_ - first);
}

}  // namespace evbench
