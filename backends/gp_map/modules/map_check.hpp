#pragma once

#include "backends/gp_map/estimate.hpp"
#include "backends/gp_map/track_table.hpp"
#include "core/plugin/options.hpp"

namespace evbench::gp_map {

struct RejectionOptions {
  bool enabled = true;
  double share = 2.0;
  int times = 3;

  void declare(OptionSet& set);
};

/// Confirms an initial map, or rejects it. An initial map can be wrong altogether. A map that most tracks have fitted
/// is not: their later errors have other reasons.
class MapCheck {
 public:
  /// `rejected`: how many initial maps were rejected before this one; `min_tracks`: that an initial map needs.
  MapCheck(const RejectionOptions& options, int min_tracks, int rejected)
      : options_(options), min_tracks_(min_tracks), rejected_(rejected) {}

  /// After each step. `searched`: the search for an alternative has failed on each plane.
  void follow(const TrackTable& tracks, bool searched);
  void confirm() { confirmed_ = true; }
  /// While it is, nothing is published.
  bool is_pending(const Estimate& estimate) const { return estimate.is_tentative() && !confirmed_; }
  bool is_rejected(const Estimate& estimate, const TrackTable& tracks) const;

 private:
  RejectionOptions options_;
  int min_tracks_, rejected_;
  bool searched_ = false;
  bool confirmed_ = false;  ///< most tracks fitted the map when it had been searched, or the data have ended
};

}  // namespace evbench::gp_map
