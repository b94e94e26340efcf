#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "backends/gp_map/counters.hpp"
#include "backends/gp_map/map.hpp"
#include "backends/gp_map/modules/initial_map.hpp"
#include "backends/gp_map/modules/state_placement.hpp"
#include "backends/gp_map/options.hpp"
#include "backends/gp_map/track_table.hpp"
#include "core/plugin/backend.hpp"
#include "core/plugin/tracking_monitor.hpp"

namespace evbench::gp_map {

/// Asynchronous continuous-time structure from motion by MAP inference under a Gaussian-process prior: Algorithm 1 of
/// Liu et al., ICRA 2022. Every observation counts at its own time.
///
/// World frame and scale: modules/initial_map.hpp. The WNOA prior alone would shrink the world to a point.
class GpMap : public BackEnd {
 public:
  using Options = gp_map::Options;

  GpMap(const Options& options, const BackEndContext& context);

  void advance(const UndistortedBatch& batch) override;
  BackEndFeedback feedback(const FeedbackNeeds& needs) override;
  void finish() override;

  Status status() const override { return monitor_.status(); }
  PoseTrajectory trajectory() const override;
  std::optional<SE3> pose(double t) const override;
  std::optional<Vector6> velocity(double t) const override;
  std::optional<Matrix12> covariance(double t) override;
  std::optional<Matrix6> relative_covariance(double t0, double t1) override;
  std::vector<Landmark> map() const override;
  std::optional<Problem> problem() const override;
  std::span<const UpdateRecord> updates() const override { return updates_; }
  std::vector<std::string> estimated_parameters() const override;
  std::vector<std::pair<std::string, std::int64_t>> counters() const override;

  /// The problem with its present estimate; only if there is a map.
  const FactorGraph& graph() const { return map_->estimate.graph(); }

 private:
  void step(double t);
  bool initialise(double t);
  void learn();
  void search_alternatives();
  void adopt(const AlternativeEstimate& other);
  void check_support();
  void predict_next_state();

  void take_observations(double t);
  void follow_observations(double t, double ahead);
  void validate_map();

  bool is_pending() const { return map_->check.is_pending(map_->estimate); }
  ControlState newest_seen() const;
  void publish_newest(double t);
  void publish_recent(double t);
  void report(const char* kind, std::string text) const;
  void record_final_prior();
  void add_record(double t, double seconds, int iterations, std::optional<double> cost);

  Options options_;
  BackEndContext context_;
  StatePlacement placement_;
  InitialMapFinder initial_map_;
  TrackTable tracks_;
  std::optional<Map> map_;  ///< from the initial map on
  Counters counters_;
  TrackingMonitor monitor_;
  const double information_share_;   ///< factor of covariances: RobustLoss::information_share()
  double seconds_since_step_ = 0.0;  ///< spent on single observations
  double until_ = 0.0;               ///< [s] end of the last batch
  std::optional<double> published_;  ///< [s] time of the last published pose
  std::vector<UpdateRecord> updates_;
};

}  // namespace evbench::gp_map
