#pragma once

#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "backends/gp_map/initial_map.hpp"
#include "backends/gp_map/map_estimate.hpp"
#include "backends/gp_map/options.hpp"
#include "backends/gp_map/recent_hypothesis.hpp"
#include "backends/gp_map/state_placement.hpp"
#include "backends/gp_map/time_span.hpp"
#include "core/plugin/backend.hpp"
#include "core/plugin/tracking_monitor.hpp"
#include "core/structure/track_buffer.hpp"

namespace evbench::gp_map {

/// Asynchronous continuous-time structure from motion by MAP inference under a Gaussian-process prior: Algorithm 1 of
/// Liu et al., ICRA 2022. Every observation counts at its own time.
///
/// World frame and scale: initial_map.hpp. The WNOA prior alone would shrink the world to a point.
class GpMap : public BackEnd {
 public:
  using Options = gp_map::Options;

  GpMap(const Options& options, const BackEndContext& context);

  void advance(const TrackBatch& batch) override;
  Feedback feedback(const FeedbackNeeds& needs) override;
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

  /// The problem with its present estimate; only if there is a map.
  const FactorGraph& graph() const { return map_->engine.graph(); }

 private:
  /// A track that waits until its landmark can be located, is a landmark, has drifted from one, or was an outlier.
  struct Track {
    enum class Role { waiting, landmark, drifted, outlier } role = Role::waiting;
    int landmark = -1;    ///< its index in the engine
    int tried_with = 0;   ///< observations at the last failed attempt to locate it
    bool misfit = false;  ///< that attempt failed because no point fits them
    bool ended = false;
    bool mismatched = false;                       ///< until it ends, it does not show its landmark
    std::optional<Matrix3> covariance = {};        ///< of the landmark; computed on demand after the track's end
    std::optional<Matrix2> image_covariance = {};  ///< of its expected image [px²], computed in
    std::size_t expected_at = 0;                   ///< this step of the map
  };

  /// The position of a track's landmark, with the prior on it.
  struct Location {
    std::optional<std::pair<Vector3, LandmarkPrior>> place = {};  ///< none yet,
    bool misfit = false;                                          ///< or none because no point fits the observations
  };

  // Algorithm 1, a line each.
  void step(double t);
  void take_observations(double t);
  bool initialise(double t);
  void remove_outliers();
  void extrapolate_state(double t);
  void add_observations();
  void add_landmarks();
  void drop_guessed_depths();
  void bound_leverage();
  void optimise();
  void check_reappeared();
  void learn();
  void learn_from_smoothed(const TimeSpan& span, std::span<const double> surplus = {});
  void search_alternatives();
  void confirm_map();
  bool is_rejected() const;
  void reinitialise();
  void check_support();
  void drop_ended_tracks(double t);
  void predict_tracks();

  std::optional<HypothesisSearch> begin_search(StructureHypothesis hypothesis, bool tentative) const;
  void adopt(const RecentHypothesis& other);
  void recall_rejected();
  void reject_reassociation(TrackId id, const Reappearance& seen);
  int mismatched_tracks() const;
  void follow_observations(double t, double ahead);
  void take(const TrackObservation& z);
  void observe_landmark(Track& track, const TrackObservation& z);
  bool continue_landmark(const Track& track);
  void split_track(TrackId id);
  void become_landmark(TrackId track, int landmark);
  bool is_reappearing(int landmark) const;
  bool is_outlier(int landmark);
  void become_outlier(int landmark);
  bool end_track_of(int landmark, Track::Role role);
  void anchor_scale_without(int leaving);
  Location locate(TrackId id) const;
  double median_depth() const;
  ControlState newest_seen() const;
  std::vector<ExpectedFeature> expected_features();
  const std::vector<TrackId>& nearly_in_view();
  std::optional<Matrix3> covariance_of_ended(Track& track);
  const std::optional<Matrix12>& newest_covariance();
  const std::optional<Matrix2>& image_covariance(Track& track, const Eigen::Matrix<double, 2, 12>& J_state,
                                                 const Matrix23& J_landmark);
  int landmarks_in_view() const;
  bool is_tentative() const { return map_->moved < MapEstimate::kTentative; }
  bool is_pending() const { return is_tentative() && !map_->confirmed; }
  void publish_newest(double t);
  void publish_recent(double t);
  Engine::OptimiseSummary estimate_everything();
  void test_depth_reversal();
  void validate_map();
  void reject_outliers(const NoiseLearner& noise, const TimeSpan& span);
  void truncate_track(int landmark, double from);
  void estimate_track_noise(const NoiseLearner& noise, const TimeSpan& span);
  void record_final_prior();
  void add_record(double t, double seconds, int iterations, std::optional<double> cost);

  Options options_;
  BackEndContext context_;
  StatePlacement placement_;
  InitialMapFinder initial_map_;
  std::optional<MapEstimate> map_;  ///< from the initial map on, unless it is rejected
  std::map<TrackId, Track> tracks_;
  TrackBuffer waiting_;                    ///< observations of waiting tracks
  TrackBuffer tentative_;                  ///< of all tracks, while the map is tentative
  std::set<TrackId> live_;                 ///< live tracks, and tracks that have ended since the last step
  std::vector<TrackObservation> pending_;  ///< later than the newest state
  std::vector<TrackEnd> ending_;           ///< likewise
  const double information_share_;         ///< factor of covariances: RobustLoss::information_share()
  int times_rejected_ = 0;                 ///< number of rejected initial maps
  bool reinitialised_ = false;             ///< since the last feedback
  double seconds_since_step_ = 0.0;        ///< spent on single observations
  TrackingMonitor monitor_;
  double until_ = 0.0;                                           ///< [s] end of the last batch
  double published_ = -std::numeric_limits<double>::infinity();  ///< [s] time of the last published pose
  std::vector<UpdateRecord> updates_;
};

}  // namespace evbench::gp_map
