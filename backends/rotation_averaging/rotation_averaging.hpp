#pragma once

#include <deque>
#include <map>
#include <vector>

#include "backends/rotation_averaging/rotation_graph.hpp"
#include "core/plugin/backend.hpp"
#include "core/plugin/options.hpp"
#include "core/plugin/tracking_monitor.hpp"

namespace evbench {

/// Rotation-only odometry: what a front-end's tracks say of a camera that only rotates. At even times, the frames, each
/// track's direction is interpolated between its observations; of pairs of frames the relative rotation aligns the
/// directions of the tracks that both see; the trajectory is the average of all pairs (Liu, Parra and Chin, CVPR 2021,
/// do so with the rotations that they register). Positions are zero, and there is no map: a translation is not seen,
/// and turns the rotation.
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

  void advance(const TrackBatch& batch) override;
  Feedback feedback(const FeedbackNeeds& needs) override;
  void finish() override;
  Status status() const override { return monitor_.status(); }
  PoseTrajectory trajectory() const override;
  std::vector<Landmark> map() const override { return {}; }
  std::span<const UpdateRecord> updates() const override { return updates_; }

 private:
  struct Frame {
    double t;  ///< [s]
    std::map<TrackId, Vector3> directions = {};
  };
  void take(const TrackObservation& z);
  void close_frame();
  double time_of(std::size_t frame) const { return *start_ + options_.interval * static_cast<double>(frame); }

  Options options_;
  BackEndContext context_;
  TrackingMonitor monitor_;
  std::optional<double> start_;                ///< [s] of the first frame
  std::map<TrackId, TrackObservation> last_;   ///< of each track
  std::deque<Frame> frames_;                   ///< as far back as pairs reach, and those that are not closed
  std::size_t first_ = 0;                      ///< frame that frames_ begins with
  std::vector<Eigen::Quaterniond> rotations_;  ///< of closed frames: R_world_camera
  std::vector<RotationEdge> edges_;
  double until_ = 0.0;  ///< [s] of the last batch
  std::vector<UpdateRecord> updates_;
};

}  // namespace evbench
