#include "core/data/seeds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "core/data/tracks.hpp"
#include "core/io/path.hpp"
#include "core/support/error.hpp"

namespace evbench {

Seeds::Seeds(const std::string& path, const std::string& folder) {
  if (path.empty()) return;
  std::set<TrackId> known;
  for (const TrackObservation& z : read_tracks(resolve_path(path, folder), kAnySize, kAnySize).observations) {
    if (known.insert(z.track).second) seeds_.push_back(z);
  }
  if (known.contains(std::numeric_limits<TrackId>::max())) {
    throw InputError(
        fmt::format("{}: the id {} leaves none above it for other tracks", path, std::numeric_limits<TrackId>::max()));
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
