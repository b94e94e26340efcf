#pragma once

#include <deque>
#include <evbench/plugin.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "initial_map.hpp"
#include "options.hpp"

namespace spline_map {

/// Continuous-time structure from motion with a cubic B-spline (Mueggler et al., T-RO 2018): every observation enters
/// at its own time.
///
/// Every update period the spline is extended at constant velocity, the knots of the sliding window and the landmarks
/// in view are optimised with older knots fixed, then tracks become landmarks or are removed. finish() optimises
/// everything. World frame and unit of length: initial_map.hpp.
class SplineMap : public evbench::BackEnd {
 public:
  using Options = spline_map::Options;

  SplineMap(const Options& options, const evbench::BackEndContext& context);

  void advance(const evbench::UndistortedBatch& batch) override;
  evbench::BackEndFeedback feedback(const evbench::FeedbackNeeds& needs) override;
  void finish() override;

  evbench::Status status() const override { return monitor_.status(); }
  evbench::PoseTrajectory trajectory() const override;
  std::optional<SE3> pose(double t) const override;
  std::optional<Vector6> velocity(double t) const override;
  std::vector<evbench::Landmark> map() const override;
  std::span<const evbench::UpdateRecord> updates() const override { return updates_; }

 private:
  void update(double t);
  void take_observations(double t);
  void initialise(double t);
  SolveReport optimise(double t);
  void add_landmarks(double t);
  std::vector<evbench::UndistortedObservation> observations_of(evbench::TrackId track) const;
  void add_landmark(evbench::TrackId track, const Vector3& position);
  void remove_outliers(double since);
  void watch(double from, double t);
  void lose();
  void locate_the_rest();
  void solve_everything();
  bool covers(double t) const { return mapped_ && t >= spline_.start() && t <= newest_; }
  Eigen::Matrix2d prediction_covariance(const MappedTrack& landmark, const SE3& T) const;

  Options options_;
  evbench::BackEndContext context_;
  InitialMapFinder initial_map_;
  evbench::TrackingMonitor monitor_;

  std::deque<evbench::UndistortedObservation> pending_;  ///< later than the newest estimate
  evbench::TrackBuffer tracks_;                  ///< tracks that are not landmarks (yet), and the ids of removed ones
  std::map<evbench::TrackId, double> tried_at_;  ///< [s] last failed attempt to triangulate a track
  std::deque<evbench::TrackEnd> ending_;         ///< later than the newest estimate
  std::set<evbench::TrackId> live_;              ///< tracks that have begun and not ended
  std::vector<evbench::TrackId> new_outliers_;

  bool mapped_ = false;  ///< there is a map: spline, gauge and landmarks are valid
  Spline spline_;
  Gauge gauge_;
  Landmarks landmarks_;
  double observed_ = 0.0;               ///< [s] of the newest observation of a landmark
  double newest_ = 0.0;                 ///< [s] of the newest estimate
  std::optional<double> first_update_;  ///< [s]
  long updates_made_ = 0;               ///< updates are at first_update_ + updates_made_ · period
  double until_ = 0.0;                  ///< [s] of the last batch
  std::vector<evbench::UpdateRecord> updates_;
};

}  // namespace spline_map
