#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/data/causal_poses.hpp"
#include "core/data/landmark.hpp"
#include "core/data/problem.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/pose_trajectory.hpp"
#include "core/plugin/exchange.hpp"
#include "core/plugin/status.hpp"

namespace evbench {

/// Something that happened to the estimate.
struct RunEvent {
  double t = 0.0;    ///< [s], sequence time
  std::string kind;  ///< a word for programs: "initialised", "lost"
  std::string text;  ///< for people, without the time
};

/// What a back-end gets in addition to its options. What happens leaves at once through its functions: causal poses,
/// events, lines of the log. What is known is asked for by the queries of BackEnd, and nothing leaves by both.
struct BackEndContext {
  PinholeCamera camera;    ///< of the undistorted pixels that it observes
  std::uint64_t seed = 0;  ///< of all random numbers that it draws
  /// [s] How long the motion model alone may carry the estimate before the back-end is lost. The same for all back-ends
  /// of a comparison; TrackingMonitor (tracking_monitor.hpp) implements the rule.
  double patience = 1.0;
  std::string folder;             ///< base of relative paths in options
  std::string place = "backend";  ///< place of the options, for messages: "config.json: backend"
  /// Publishes a pose of the causal estimate as soon as it is computed: {t, T}, optionally {{t, T}, known_at,
  /// velocity}. known_at is the observation time up to which the pose includes all data; it must not decrease, and the
  /// harness adds the delay of the front-end (TrackBatch::seen). velocity is the body velocity at t. An update
  /// publishes its newest pose (later than all published before) first. A pose published (again) for an older time is
  /// an improved estimate, which scores at a latency use (fixed-lag smoothing).
  std::function<void(const CausalPose&)> publish = [](const CausalPose&) {};
  std::function<void(const std::string&)> log = [](const std::string&) {};  ///< writes a line to the run's log.txt
  /// Adds an event to `events` in metrics.json and, with its time, to log.txt.
  std::function<void(const RunEvent&)> event = [](const RunEvent&) {};
};

/// Time, size and result of one update: a line of timing.csv.
struct UpdateRecord {
  double t = 0.0;        ///< [s], sequence time
  double seconds = 0.0;  ///< wall time
  int states = 0;        ///< poses or control states in the problem
  int landmarks = 0;
  int observations = 0;  ///< in the problem
  int iterations = 0;
  std::optional<double> cost;          ///< ½ Σ ρ(‖whitened residual‖²) of the whole problem, if computed
  std::vector<double> estimated = {};  ///< values of BackEnd::estimated_parameters(); empty: none yet
};

/// A back-end of visual odometry: track observations in, trajectory and map out.
///
/// Order of calls: advance any number of times, each optionally followed by feedback; finish once; then queries of the
/// final estimate. World frame and scale are the back-end's own. A back-end that is lost, or whose stationary period
/// turned out to be wrong, gets no more data; its estimate until then is kept. The run re-initialises with a new
/// back-end, and the trajectory then consists of segments. Segments whose maps share enough landmarks (of the same
/// tracks) are aligned and joined.
class BackEnd {
 public:
  virtual ~BackEnd() = default;

  /// Processes a batch and updates the estimate up to batch.until.
  virtual void advance(const UndistortedBatch& batch) = 0;

  /// The current estimate at batch.until of the last batch. May be called after any advance, or never. By default there
  /// is nothing that a front-end could use.
  virtual BackEndFeedback feedback(const FeedbackNeeds& /*needs*/) { return {}; }

  /// No more data: computes the final (smoothed) estimate.
  virtual void finish() = 0;

  /// By default ok; the harness takes a back-end without any pose at the end for failed.
  virtual Status status() const { return {}; }

  /// The poses of the estimate: control states or keyframes. Empty before initialisation. Also called during the run,
  /// as is map(), to align the worlds of two back-ends.
  virtual PoseTrajectory trajectory() const = 0;

  /// Pose at any time that the trajectory covers, for back-ends with a continuous-time model. None for the others: the
  /// caller interpolates between their poses.
  virtual std::optional<SE3> pose(double /*t*/) const { return std::nullopt; }

  /// Body velocity (ω, ν), for back-ends with a continuous-time model.
  virtual std::optional<Vector6> velocity(double /*t*/) const { return std::nullopt; }

  /// Covariance of (δpose, δvelocity) at t, T ← T Exp(δpose), in the gauge of the back-end's anchor. Not const: it may
  /// factorise changed parts of the problem; the estimate does not change.
  virtual std::optional<Matrix12> covariance(double /*t*/) { return std::nullopt; }

  /// Covariance of δ for the relative pose T(t0)⁻¹ T(t1) ← T(t0)⁻¹ T(t1) Exp(δ), t0 < t1, both times of trajectory()'s
  /// poses. Not const, as above.
  virtual std::optional<Matrix6> relative_covariance(double /*t0*/, double /*t1*/) { return std::nullopt; }

  virtual std::vector<Landmark> map() const { return {}; }

  /// The final estimation problem, for back-ends whose problem has that form.
  virtual std::optional<Problem> problem() const { return std::nullopt; }

  virtual std::span<const UpdateRecord> updates() const { return {}; }

  /// Names of the parameters that it estimates from the data (`noise_scale`, ...): columns of estimated_parameters.csv,
  /// which has a line for each update.
  virtual std::vector<std::string> estimated_parameters() const { return {}; }

  /// What it counted until now, by name: `counters` in metrics.json, summed over the back-ends of a run.
  virtual std::vector<std::pair<std::string, std::int64_t>> counters() const { return {}; }
};

}  // namespace evbench
