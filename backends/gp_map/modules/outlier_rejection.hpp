#pragma once

#include "backends/gp_map/estimate.hpp"
#include "backends/gp_map/smoother.hpp"
#include "backends/gp_map/track_table.hpp"
#include "core/plugin/options.hpp"
#include "core/smoother/time_span.hpp"

namespace evbench::gp_map {

struct OutlierOptions {
  bool enabled = true;
  double threshold = 5.0;
  double running = 2.0;

  void declare(OptionSet& set);
};

/// Removes landmarks whose tracks follow something else, and truncates those whose tracks drifted later.
class OutlierRejection {
 public:
  explicit OutlierRejection(const OutlierOptions& options) : options_(options) {}

  /// Removes landmarks of the newest interval whose error at the last optimum was too large compared with all tracks.
  /// Newer observations do not count: their distance from an extrapolated pose depends on the motion first.
  void reject_newest(Estimate& estimate, TrackTable& tracks) const;

  /// The same for landmarks from index `first` on.
  void reject_since(int first, Estimate& estimate, TrackTable& tracks) const;

  /// By the errors in a span in which the motion is known from both sides: outliers are removed, and a drifted track
  /// keeps its landmark until it drifted.
  void reject_smoothed(Estimate& estimate, TrackTable& tracks, const TimeSpan& span) const;

 private:
  bool is_outlier(Estimate& estimate, int landmark) const;

  OutlierOptions options_;
};

}  // namespace evbench::gp_map
