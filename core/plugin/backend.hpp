#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/data/landmark.hpp"
#include "core/data/causal_poses.hpp"
#include "core/data/problem.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/pose_trajectory.hpp"
#include "core/plugin/exchange.hpp"
#include "core/plugin/status.hpp"

namespace evbench {

/// What a back-end is given besides its options.
struct BackEndContext {
  PinholeCamera camera;    ///< of the undistorted pixels that it will observe
  std::uint64_t seed = 0;  ///< for whatever it draws
  /// [s] How long a motion model alone may carry the estimate: then the back-end is lost. The same for all back-ends of
  /// a comparison; TrackingMonitor (tracking_monitor.hpp) has the rule.
  double patience = 1.0;
  std::string folder;             ///< what relative paths in options refer to
  std::string place = "backend";  ///< where the options stand, for messages: "config.json: backend"
  /// Takes poses of the causal estimate as they are made: {t, T}, and with {{t, T}, known_at, velocity} when the data
  /// were complete that are in it, and how it moves. A pose later than all told before is the newest: it is told first
  /// of those that an update makes, at once. What is said of an older time (again) is a better estimate, for whoever
  /// can wait: for one that smooths. known_at must not decrease. It is in the observations' time: that a front-end told
  /// them later (TrackBatch::seen) is added by the harness.
  std::function<void(const CausalPose&)> publish = [](const CausalPose&) {};
  std::function<void(const std::string&)> log = [](const std::string&) {};  ///< a line for the run's log.txt
};

/// What one update cost and did: a line of timing.csv.
struct UpdateRecord {
  double t = 0.0;        ///< [s], sequence time
  double seconds = 0.0;  ///< wall time
  int states = 0;        ///< poses or control states in the problem
  int landmarks = 0;
  int observations = 0;  ///< in the problem
  int iterations = 0;
  std::optional<double> cost;  ///< ½ Σ ρ(‖whitened residual‖²) of the whole problem, where the update computed it
  std::vector<double> learnt = {};  ///< values of what BackEnd::estimated_parameters() names; empty: nothing yet
};

/// A back-end of visual odometry: track observations in, trajectory and map out.
///
/// Calls come in this order: advance, any number of times, each maybe followed by feedback; finish, once; afterwards
/// queries of the final estimate. An estimate's world frame and scale are the back-end's own. One that is lost, or was
/// told of a stand that was none, is given no more data, and its estimate until then is kept. The run goes on with
/// another one made anew, and the trajectory is then in segments, but for those whose maps show by landmarks of the same
/// tracks how one lies in the other.
class BackEnd {
 public:
  virtual ~BackEnd() = default;

  /// Takes a batch, undistorted pixels, and brings the estimate up to batch.until.
  virtual void advance(const TrackBatch& batch) = 0;

  /// What it knows at batch.until of the last batch. May be called after any advance, or never.
  virtual Feedback feedback(const FeedbackNeeds& needs) = 0;

  /// No more data: make the final estimate.
  virtual void finish() = 0;

  virtual Status status() const = 0;

  /// The estimate's own poses: control states, frames. Empty before initialisation. Asked for while data come in, too,
  /// as is the map: to find one back-end's world in another's.
  virtual PoseTrajectory trajectory() const = 0;

  /// Pose at any time that the trajectory covers, for back-ends with a continuous model; none for the others, between
  /// whose poses whoever asks interpolates.
  virtual std::optional<SE3> pose(double /*t*/) const { return std::nullopt; }

  /// Body velocity (ω, ν), for back-ends with a continuous model.
  virtual std::optional<Vector6> velocity(double /*t*/) const { return std::nullopt; }

  /// Covariance of (δpose, δvelocity) at t, T ← T Exp(δpose), in the gauge of the back-end's anchor. Not const: it may
  /// have to factorise what has changed; the estimate stays as it is.
  virtual std::optional<Matrix12> covariance(double /*t*/) { return std::nullopt; }

  /// Covariance of δ for the relative pose T(t0)⁻¹ T(t1) ← T(t0)⁻¹ T(t1) Exp(δ), t0 < t1, both times of trajectory()'s
  /// poses. Not const, as above.
  virtual std::optional<Matrix6> relative_covariance(double /*t0*/, double /*t1*/) { return std::nullopt; }

  virtual std::vector<Landmark> map() const = 0;

  /// The estimation problem that the run ended with, for back-ends whose problem has that form.
  virtual std::optional<Problem> problem() const { return std::nullopt; }

  virtual std::span<const UpdateRecord> updates() const { return {}; }

  /// Names of the parameters that it learns from the data (`noise_scale`, ...): columns of estimated_parameters.csv, by update.
  virtual std::vector<std::string> estimated_parameters() const { return {}; }
};

}  // namespace evbench
