#pragma once

#include <limits>
#include <span>
#include <vector>

#include "backends/gp_map/robust_loss.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/gp_interval.hpp"
#include "core/support/index.hpp"

namespace evbench::gp_map {

/// An observation of a landmark at its own time, on undistorted pixels.
struct Observation {
  double t = 0.0;  ///< [s]
  Vector2 pixel = Vector2::Zero();
  double inverse_sigma = 1.0;  ///< [1/px]
};

/// The observations in one interval (t_{k−1}, t_k], those of one landmark together and in time order: what one
/// landmark's observations in one interval share is computed once.
class IntervalObservations {
 public:
  struct Group {
    int landmark = 0;
    int begin = 0, end = 0;  ///< range in all()
  };

  void add(int landmark, const Observation& observation);
  /// A landmark's from a time on; returns how many there were.
  int remove(int landmark, double from = -std::numeric_limits<double>::infinity());
  void scale_sigmas(int landmark, double factor);

  const std::vector<Observation>& all() const { return observations_; }
  const std::vector<Group>& groups() const { return groups_; }  ///< ordered by landmark
  std::span<const Observation> of(const Group& group) const {
    return std::span(observations_).subspan(index(group.begin), index(group.end - group.begin));
  }
  std::span<const Observation> of(int landmark) const;  ///< empty for one that is not observed

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

/// Holds the scale: the mean nearness n_j = 1/(1 + ‖l_j − origin‖/unit) of some landmarks keeps its value, residual
/// (mean_nearness − 1/N Σ n_j)/(change · sigma), change = 1/N Σ n_j (1 − n_j), by which the mean falls as the logarithm
/// of all distances grows. Every observation ties the map's depth to the motion, so this holds the whole trajectory's
/// scale; the length of one baseline would hold no more than that baseline. Nearness is bounded: a landmark whose depth
/// nothing tells, running off to infinity, would let all others shrink to a point while it keeps their mean log
/// distance.
struct ScaleAnchor {
  Vector3 origin = Vector3::Zero();
  std::vector<int> landmarks;  ///< empty: no anchor
  double unit = 1.0;           ///< geometric mean distance when the scale was anchored
  double mean_nearness = 0.0, change = 1.0;
  double sigma = 1e-4;  ///< of the scale's logarithm

  double nearness(const Vector3& landmark) const { return 1.0 / (1.0 + (landmark - origin).norm() / unit); }
};

/// The continuous-time structure-from-motion problem: control states in time order joined by the WNOA prior, landmarks,
/// every observation in the interval that holds its time, priors. Solvers read factors from here and write estimates
/// back; they differ in how they solve, not in what.
struct FactorGraph {
  struct Landmark {
    Vector3 position = Vector3::Zero();  ///< world frame
    LandmarkPrior prior;
    std::vector<int> intervals;  ///< in which it is observed, ascending
    bool alive = true;           ///< false once removed; its index is not used again
    double sigma_scale = 1.0;    ///< multiplies its observations' sigmas
  };

  PinholeCamera camera;
  Vector6 qc = Vector6::Ones();  ///< of the WNOA prior over the intervals that are added from now on
  RobustLoss loss;

  std::vector<ControlState> states;
  std::vector<Landmark> landmarks;
  std::vector<IntervalObservations> intervals;  ///< intervals[k] ends in state k; intervals[0] is empty
  std::vector<Vector6> qcs;                     ///< qcs[k]: power spectral density of the prior over interval k
  /// expansions[k] ≥ 0 of interval k: a cost of −expansions[k] log s, s the distance of what it sees
  /// (scene_distance()). A prior whose density is learnt has no scale, but as a fixed density it draws the world
  /// together, with a force of eᵀ Q⁻¹ e of its translations an interval: this one is as large and the other way.
  std::vector<double> expansions;
  std::vector<PosePrior> pose_priors;
  std::vector<VelocityPrior> velocity_priors;
  ScaleAnchor anchor;

  /// Appends a state after the newest one, and the motion prior between them.
  void add_state(const ControlState& state);

  /// Takes the newest state back, with the observations in its interval and the priors on it.
  void remove_newest_state();

  int add_landmark(const Vector3& position, const LandmarkPrior& prior = {});

  /// Makes these landmarks hold the scale that they have now.
  void anchor_scale(const Vector3& origin, std::vector<int> anchors);

  /// Removes a landmark with its observations. The scale anchor goes on without it, at the scale of now.
  void remove_landmark(int landmark);

  /// Removes a landmark's observations from a time on.
  void remove_observations(int landmark, double from);

  /// Makes the sigmas of a landmark's observations, those to come included, so many times those that they are given.
  void scale_sigmas(int landmark, double scale);

  /// An observation with its sigma as given, as it counts here.
  Observation scaled(int landmark, const Observation& given) const;

  /// The interval k with t in (t_{k−1}, t_k]; t = t_0 belongs to the first. −1 outside.
  int interval_of(double t) const;

  /// The first state later than t [s], at which the first interval ends that ends later; one past the newest when there
  /// is none.
  int first_state_after(double t) const;

  /// False, and nothing added, when t lies outside the states' span.
  bool add_observation(int landmark, const Observation& observation);

  /// Drops the observations of an interval that is not estimated any more.
  void forget_interval(int k);

  int observation_count() const { return observation_count_; }

 private:
  int observation_count_ = 0;
};

}  // namespace evbench::gp_map
