#include "backends/gp_map/modules/map_check.hpp"

namespace evbench::gp_map {

void RejectionOptions::declare(OptionSet& set) {
  set.add("enabled", enabled, "an initial map that most tracks do not fit is rejected");
  set.add("share", share, "of tracks that do not fit to landmarks in view, at which it is rejected").above(0.0);
  set.add("times", times, "rejections, at most: if most tracks follow nothing, no other map is better").range(0);
}

void MapCheck::follow(const TrackTable& tracks, bool searched) {
  searched_ = searched;
  if (searched && tracks.mismatched() <= tracks.landmarks_in_view()) confirmed_ = true;
}

bool MapCheck::is_rejected(const Estimate& estimate, const TrackTable& tracks) const {
  if (!options_.enabled || !is_pending(estimate) || !searched_ || rejected_ >= options_.times) return false;
  const int mismatched = tracks.mismatched();
  return mismatched >= min_tracks_ && mismatched > options_.share * tracks.landmarks_in_view();
}

}  // namespace evbench::gp_map
