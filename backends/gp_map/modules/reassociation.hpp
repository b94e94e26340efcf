#pragma once

#include "backends/gp_map/estimate.hpp"
#include "backends/gp_map/modules/return_budget.hpp"
#include "backends/gp_map/track_table.hpp"
#include "core/data/track.hpp"
#include "core/plugin/options.hpp"

namespace evbench::gp_map {

struct ReassociationOptions {
  bool enabled = true;
  int returns = 120;
  double threshold = 5.0;
  double time = 0.2;

  void declare(OptionSet& set);
};

/// Decides whether a re-acquired track still shows its landmark.
class Reassociation {
 public:
  Reassociation(const ReassociationOptions& options, double sigma_scale)
      : options_(options), sigma_scale_(sigma_scale), returns_(options.returns) {}

  /// An observation of a landmark's track, perhaps the first one since it was re-acquired. The track continues its
  /// landmark if the budget of returns allows it. Otherwise it becomes another landmark, with a prior where the old one
  /// is expected; the old one stays as it is.
  void observe(Estimate& estimate, TrackTable& tracks, const UndistortedObservation& z);

  /// Rejects tracks that stay far from their landmarks' expected places. None if they are most of many, because then
  /// the motion is wrong.
  void check(Estimate& estimate, TrackTable& tracks) const;

 private:
  bool continues(const Estimate& estimate, const TrackTable::Track& track);
  bool split(Estimate& estimate, TrackTable& tracks, TrackId id) const;

  ReassociationOptions options_;
  double sigma_scale_;
  ReturnBudget returns_;
};

}  // namespace evbench::gp_map
