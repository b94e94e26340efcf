#pragma once

#include <deque>
#include <map>
#include <vector>

#include "backends/rotation_averaging/rotation_graph.hpp"
#include "core/plugin/backend.hpp"
#include "core/plugin/options.hpp"
#include "core/plugin/tracking_monitor.hpp"

namespace evbench {

/// Rotation-only odometry from any front-end's tracks, for a camera that only rotates. At evenly spaced times, the
/// samples, each track's direction is interpolated between its observations. For pairs of samples the relative rotation
/// aligns the directions of the tracks that both see. The trajectory is the average over all pairs (rotation averaging,
/// Hartley et al. 2013). Positions are zero, and there is no map: a translation is not modelled, and would be taken for
/// rotation.
class RotationAveraging : public BackEnd {
 public:
  struct Options {
    double interval = 0.02;
    int reach = 32;
    int least_tracks = 8;
    double robust_scale = 1.0;
    double longest_gap = 0.25;

    void declare(OptionSet& set);
  };

  RotationAveraging(const Options& options, const BackEndContext& context);

  void advance(const UndistortedBatch& batch) override;
  BackEndFeedback feedback(const FeedbackNeeds& needs) override;
  void finish() override;
  Status status() const override { return monitor_.status(); }
  PoseTrajectory trajectory() const override;
  std::vector<Landmark> map() const override { return {}; }
  std::span<const UpdateRecord> updates() const override { return updates_; }

 private:
  struct Sample {
    double t;  ///< [s]
    std::map<TrackId, Vector3> directions = {};
  };
  void take(const UndistortedObservation& z);
  void close_sample();
  double time_of(std::size_t sample) const { return *start_ + options_.interval * static_cast<double>(sample); }

  Options options_;
  BackEndContext context_;
  TrackingMonitor monitor_;
  std::optional<double> start_;                     ///< [s] of the first sample
  std::map<TrackId, UndistortedObservation> last_;  ///< observation of each track
  std::deque<Sample> samples_;                      ///< as far back as pairs reach, and those that are not closed
  std::size_t first_ = 0;                           ///< index of the first one in samples_
  std::vector<Eigen::Quaterniond> rotations_;       ///< of closed samples: R_world_camera
  std::vector<RotationEdge> edges_;
  double until_ = 0.0;  ///< [s] end of the last batch
  std::vector<UpdateRecord> updates_;
};

}  // namespace evbench
