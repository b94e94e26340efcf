#pragma once

#include <limits>
#include <span>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/pixel_noise.hpp"
#include "core/motion/gp_interval.hpp"
#include "core/smoother/robust_loss.hpp"
#include "core/support/index.hpp"

namespace evbench::smoother {

/// An observation of a landmark at its own time, on undistorted pixels.
struct Observation {
  double t = 0.0;  ///< [s]
  Vector2 pixel = Vector2::Zero();
  Whitening whitening = 1.0;  ///< of its residual
};

/// The observations in one interval (t_{k−1}, t_k], grouped by landmark and in time order. So terms that a landmark's
/// observations in one interval share are computed once.
class IntervalObservations {
 public:
  struct Group {
    int landmark = 0;
    int begin = 0, end = 0;  ///< range in all()
  };

  void add(int landmark, const Observation& observation);
  /// Removes a landmark's observations from a time on; returns their number.
  int remove(int landmark, double from = -std::numeric_limits<double>::infinity());
  void scale_sigmas(int landmark, double factor);

  const std::vector<Observation>& all() const { return observations_; }
  const std::vector<Group>& groups() const { return groups_; }  ///< ordered by landmark
  std::span<const Observation> of(const Group& group) const {
    return std::span(observations_).subspan(index(group.begin), index(group.end - group.begin));
  }
  std::span<const Observation> of(int landmark) const;  ///< empty if it is not observed

 private:
  std::vector<Observation> observations_;
  std::vector<Group> groups_;
};

/// Gaussian priors; sigmas are standard deviations, increments on the right.
struct PosePrior {
  int state = 0;
  SE3 T;
  Vector6 sigma = Vector6::Ones();  ///< residual Log(T⁻¹ T_state)/sigma
};
struct VelocityPrior {
  int state = 0;
  Vector6 velocity = Vector6::Zero();
  Vector6 sigma = Vector6::Ones();
};
struct LandmarkPrior {
  Vector3 position = Vector3::Zero();
  double sigma = std::numeric_limits<double>::infinity();  ///< infinite: no prior
};

/// Factor that fixes the scale: the mean nearness n_j = 1/(1 + ‖l_j − origin‖/unit) of some landmarks keeps its value.
/// Its residual is (mean_nearness − 1/N Σ n_j)/(change · sigma); change = 1/N Σ n_j (1 − n_j) is the decrease of the
/// mean as the logarithm of all distances grows. Every observation ties the depth of the map to the motion, so this
/// fixes the scale of the whole trajectory; the length of one baseline would fix that baseline only. Nearness is
/// bounded. With the mean log distance instead, a landmark of undetermined depth that runs off to infinity would let
/// all others shrink to a point.
struct ScaleAnchor {
  Vector3 origin = Vector3::Zero();
  std::vector<int> landmarks;  ///< empty: no anchor
  double unit = 1.0;           ///< geometric mean distance when the scale was anchored
  double mean_nearness = 0.0, change = 1.0;
  double sigma = 1e-4;  ///< of the scale's logarithm

  double nearness(const Vector3& landmark) const { return 1.0 / (1.0 + (landmark - origin).norm() / unit); }
};

/// The continuous-time structure-from-motion problem: control states in time order joined by the motion prior,
/// landmarks, every observation in the interval of its time, priors. Solvers read factors from here and write estimates
/// back.
struct FactorGraph {
  struct Landmark {
    Vector3 position = Vector3::Zero();  ///< world frame
    LandmarkPrior prior;
    std::vector<int> intervals;  ///< in which it is observed, ascending
    bool alive = true;           ///< false once removed; its index is not used again
    double sigma_scale = 1.0;    ///< multiplies its observations' sigmas
  };

  PinholeCamera camera;
  MotionPrior motion_prior;
  Vector6 qc = Vector6::Ones();  ///< of the prior in intervals that are added from now on
  RobustLoss loss;

  std::vector<ControlState> states;
  std::vector<Landmark> landmarks;
  std::vector<IntervalObservations> intervals;  ///< intervals[k] ends in state k; intervals[0] is empty
  /// qcs[k]: power spectral density of the prior over interval k; qcs[0]: of the first state's acceleration, if it has
  /// one.
  std::vector<Vector6> qcs;
  /// expansions[k] ≥ 0: adds the cost −expansions[k] log s to interval k; s is its distance to the scene
  /// (scene_distance()). It balances a bias of the prior: a prior with an estimated density has no scale, but as a
  /// fixed density it contracts the world with a force of eᵀ Q⁻¹ e of the translations of each interval. The expansion
  /// is an equal force in the opposite direction.
  std::vector<double> expansions;
  std::vector<PosePrior> pose_priors;
  std::vector<VelocityPrior> velocity_priors;
  ScaleAnchor anchor;

  int state_size() const { return motion_prior.state_size(); }

  /// Interval k (1 ≤ k) at the estimate.
  GpInterval interval(int k) const { return {states[index(k - 1)], states[index(k)], motion_prior}; }

  /// Appends a state after the newest one, and the motion prior between them.
  void add_state(const ControlState& state);

  /// Removes the newest state, with the observations in its interval and the priors on it.
  void remove_newest_state();

  int add_landmark(const Vector3& position, const LandmarkPrior& prior = {});

  /// Anchors the present scale of these landmarks.
  void anchor_scale(const Vector3& origin, std::vector<int> anchors);

  /// Removes a landmark with its observations. The scale anchor continues without it, at the present scale.
  void remove_landmark(int landmark);

  /// Removes a landmark's observations from a time on.
  void remove_observations(int landmark, double from);

  /// Scales the given sigmas of a landmark's observations, including future ones.
  void scale_sigmas(int landmark, double scale);

  /// An observation with the landmark's scale of sigmas applied.
  Observation scaled(int landmark, const Observation& given) const;

  /// The interval k with t in (t_{k−1}, t_k]; t = t_0 belongs to the first. −1 outside.
  int interval_of(double t) const;

  /// The first state later than t [s], the end of the first interval that ends later; one past the newest if there is
  /// none.
  int first_state_after(double t) const;

  /// Returns false and adds nothing if t is outside the states' span.
  bool add_observation(int landmark, const Observation& observation);

  /// Drops the observations of an interval that is no longer estimated.
  void drop_observations(int k);

  int observation_count() const { return observation_count_; }

 private:
  int observation_count_ = 0;
};

}  // namespace evbench::smoother
