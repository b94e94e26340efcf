#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "backends/gp_map/engine/engine.hpp"
#include "backends/gp_map/first_map.hpp"
#include "backends/gp_map/noise_learning.hpp"
#include "backends/gp_map/observation_follower.hpp"
#include "backends/gp_map/options.hpp"
#include "backends/gp_map/prior_learning.hpp"
#include "backends/gp_map/recent_explanation.hpp"
#include "backends/gp_map/recent_motion.hpp"
#include "backends/gp_map/return_budget.hpp"
#include "backends/gp_map/state_placement.hpp"
#include "backends/gp_map/time_span.hpp"
#include "backends/gp_map/violent_motion.hpp"
#include "core/plugin/backend.hpp"
#include "core/plugin/tracking_monitor.hpp"
#include "core/structure/track_buffer.hpp"

namespace evbench::gp_map {

/// Asynchronous continuous-time structure from motion by MAP inference under a Gaussian-process prior: Algorithm 1 of
/// Liu et al., ICRA 2022. Every observation counts at its own time.
///
/// World frame and scale: first_map.hpp. The WNOA prior alone would shrink the world to a point.
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
  std::vector<std::string> learnt() const override;

  /// The problem with its present estimate; only where there is a map.
  const FactorGraph& graph() const { return engine_->graph(); }

 private:
  /// A track that waits until its landmark can be located, is a landmark, slid off one, or was an outlier.
  struct Track {
    enum class Role { waiting, landmark, slid, outlier } role = Role::waiting;
    int landmark = -1;    ///< the engine's number
    int tried_with = 0;   ///< observations at the last vain attempt to locate it
    bool misfit = false;  ///< that was vain as no place fits them
    bool ended = false;
    std::optional<Matrix3> covariance = {};        ///< of the landmark, once it is asked for after the track's end
    std::optional<Matrix2> image_covariance = {};  ///< of where it is expected in the image [px²], as of
    std::size_t expected_at = 0;                   ///< so many states
  };

  /// Of a landmark: its track, and what its sigmas are multiplied by.
  struct Known {
    TrackId track = 0;
    double noise = 1.0;     ///< the track's own
    double leverage = 1.0;  ///< bounded

    double sigma_scale() const { return std::max(noise, leverage); }
  };

  // Algorithm 1, a line each.
  void step(double t);
  void take_observations(double t);
  bool initialise(double t);
  void remove_outliers();
  void extrapolate_state(double t);
  void add_observations();
  void add_landmarks();
  void trust_parallax();
  void bound_leverage();
  void optimise();
  void learn();
  void learn_with_hindsight(const TimeSpan& span, std::span<const double> surplus = {});
  void reconsider_recent();
  void recall_condemned();
  int misfits() const;
  bool is_refuted() const;
  void begin_anew();
  void check_support();
  void forget_ended_tracks(double t);
  void predict_tracks();

  std::optional<ExplanationSearch> begin_search(Supposed supposed, bool young) const;
  void go_on_with(const RecentExplanation& other);
  void follow_observations(double t, double ahead);
  void take(const TrackObservation& z);
  bool goes_on(const Track& track);
  void split(TrackId id);
  void become_landmark(TrackId track, int landmark);
  bool is_outlier(int landmark);
  void become_outlier(int landmark);
  bool end_track_of(int landmark, Track::Role role);
  void hold_scale_without(int leaving);
  std::optional<std::pair<Vector3, LandmarkPrior>> locate(TrackId id);
  double median_depth() const;
  ControlState newest_seen() const;
  std::vector<ExpectedFeature> expected_features();
  const std::vector<TrackId>& nearly_in_view();
  std::optional<Matrix3> covariance_of_ended(Track& track);
  const std::optional<Matrix12>& newest_covariance();
  const std::optional<Matrix2>& image_covariance(Track& track, const Eigen::Matrix<double, 2, 12>& J_state,
                                                 const Matrix23& J_landmark);
  int landmarks_in_view() const;
  bool is_young() const { return !(graph().states.back().t > young_until_); }
  bool is_in_doubt() const { return is_young() && !trusted_; }
  void tell_online(double t);
  void tell_recent(double t);
  Engine::OptimiseSummary estimate_everything();
  void reconsider_beginning();
  void judge_tracks(const NoiseLearner& noise, const TimeSpan& span);
  void slid_off(int landmark, double from);
  void weigh_tracks(const NoiseLearner& noise, const TimeSpan& span);
  void record_final_prior();
  void add_record(double t, double seconds, int iterations, std::optional<double> cost);

  Options options_;
  BackEndContext context_;
  StatePlacement placement_;
  FirstMapFinder first_map_;
  std::optional<Engine> engine_;  ///< from the first map on, unless that is refuted
  ObservationFollower follower_;
  std::map<TrackId, Track> tracks_;
  TrackBuffer waiting_;       ///< observations of waiting tracks
  TrackBuffer young_;         ///< of all tracks, while the map is young
  std::set<TrackId> live_;    ///< tracks that are alive, or have ended since the last step
  std::vector<Known> known_;  ///< by landmark, of which a track that came back may have several
  std::vector<int> guessed_;  ///< landmarks at the scene's depth, until they show parallax
  ReturnBudget returns_;
  int landmarks_ = 0;                                                  ///< tracks that are landmarks
  std::vector<TrackObservation> pending_;                              ///< later than the newest state
  std::vector<TrackEnd> ending_;                                       ///< likewise
  std::vector<std::pair<int, Observation>> new_;                       ///< of landmarks, not in the engine yet
  std::pair<std::size_t, std::optional<Matrix12>> newest_covariance_;  ///< and the number of states then
  std::vector<TrackId> new_outliers_;
  std::vector<TrackId> ended_landmarks_;                ///< tracks that have ended in the last batch
  std::optional<std::vector<TrackId>> nearly_in_view_;  ///< as of the newest state
  UpdateSummary last_update_;
  ViolentMotion violent_motion_;
  PriorLearner prior_;
  const double information_told_;       ///< share of the estimate's information that the loss's weights tell
  std::optional<RecentMotion> recent_;  ///< as it is told online; from the first map on
  NoiseLearner noise_;
  std::optional<Vector6> hindsight_qc_;  ///< the newest density that has been learnt with hindsight
  double young_until_ = 0.0;             ///< [s]
  double next_hindsight_ = 0.0;          ///< [s]
  double next_search_ = 0.0;             ///< [s]
  int looks_ = 0;                        ///< for another explanation
  int times_refuted_ = 0;                ///< of first maps
  int doubts_ = 0;                       ///< vain looks that are missing until the first map is trusted
  bool trusted_ = false;                 ///< those were made, and most tracks fitted it then, or nothing more will tell
  std::optional<ExplanationSearch> search_;
  double seconds_since_step_ = 0.0;  ///< spent on single observations
  TrackingMonitor monitor_;
  double until_ = 0.0;                                        ///< [s] of the last batch
  double online_ = -std::numeric_limits<double>::infinity();  ///< [s], time of the last pose told
  std::vector<UpdateRecord> updates_;
};

}  // namespace evbench::gp_map
