#pragma once

#include "backends/gp_map/estimate.hpp"
#include "backends/gp_map/track_table.hpp"

namespace evbench::gp_map {

/// Confirms an initial map, which may be wrong, once no better one was found and most tracks fit it. Later errors have
/// other reasons.
class MapCheck {
 public:
  /// After each step. `searched`: the search for an alternative has failed on each plane.
  void follow(const TrackTable& tracks, bool searched);
  void confirm() { confirmed_ = true; }
  /// While it is, nothing is published.
  bool is_pending(const Estimate& estimate) const { return estimate.is_tentative() && !confirmed_; }

 private:
  bool confirmed_ = false;
};

}  // namespace evbench::gp_map
