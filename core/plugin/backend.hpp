#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/data/problem.hpp"
#include "core/data/track.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/gp_interval.hpp"
#include "core/motion/pose_trajectory.hpp"
#include "core/plugin/status.hpp"

namespace evbench {

/// What a back-end is given besides its options.
struct BackEndContext {
  PinholeCamera camera;    ///< of the undistorted pixels that it will observe
  std::uint64_t seed = 0;  ///< for whatever it draws
  std::function<void(const std::string&)> log = [](const std::string&) {};  ///< a line for the run's log.txt
};

struct Landmark {
  TrackId track = 0;
  Vector3 position = Vector3::Zero();  ///< world frame, up to the back-end's scale
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
};

/// What a back-end tells the front-end, which may use it or not.
struct Feedback {
  std::optional<ControlState> newest;  ///< newest pose and velocity: extrapolate to predict where features go
  std::vector<TrackId> outliers;       ///< tracks dropped as outliers since the last feedback
};

/// A back-end of visual odometry: track observations in, trajectory and map out.
///
/// Calls come in this order: observe and advance, any number of times, with times that never decrease; finish, once;
/// afterwards queries of the final estimate. An estimate's world frame and scale are the back-end's own.
class BackEnd {
 public:
  virtual ~BackEnd() = default;

  /// Takes observations in time order, undistorted.
  virtual void observe(std::span<const TrackObservation> observations) = 0;

  /// All observations up to t have been given: bring the estimate up to there.
  virtual void advance(double t) = 0;

  /// No more data: make the final estimate.
  virtual void finish() = 0;

  virtual Status status() const = 0;
  virtual Feedback feedback() { return {}; }

  /// The estimate's own poses: control states, frames. Empty before initialisation.
  virtual PoseTrajectory trajectory() const = 0;

  /// The causal estimate: each pose as it was the moment it was first estimated, never touched later.
  virtual PoseTrajectory online() const = 0;

  /// Pose at any time that the trajectory covers: by the back-end's own continuous model where it has one.
  virtual std::optional<SE3> pose(double t) const { return trajectory().pose(t); }

  /// Body velocity (ω, ν), for back-ends with a continuous model.
  virtual std::optional<Vector6> velocity(double /*t*/) const { return std::nullopt; }

  /// Covariance of (δpose, δvelocity) at t, T ← T Exp(δpose), in the gauge of the back-end's anchor.
  virtual std::optional<Matrix12> covariance(double /*t*/) const { return std::nullopt; }

  virtual std::vector<Landmark> map() const = 0;

  /// The estimation problem that the run ended with, for back-ends whose problem has that form.
  virtual std::optional<Problem> problem() const { return std::nullopt; }

  virtual std::span<const UpdateRecord> updates() const = 0;
};

}  // namespace evbench
