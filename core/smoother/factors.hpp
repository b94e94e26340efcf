#pragma once

#include <span>
#include <vector>

#include "core/smoother/cost.hpp"
#include "core/smoother/factor_graph.hpp"
#include "core/smoother/time_span.hpp"

namespace evbench::smoother {

/// Distance of a landmark's image from its observation [px]; infinite behind the camera.
double reprojection_error(const GpInterval& interval, const Vector3& landmark, const Observation& z,
                          const PinholeCamera& camera);
/// Mean reprojection error of a landmark over all its observations.
double reprojection_mean(const FactorGraph& graph, int landmark);

/// Calls visit(interval, observation) for each of a landmark's observations, in the intervals that overlap this span.
template <class Visit>
void for_each_observation(const FactorGraph& graph, int landmark, const TimeSpan& span, Visit visit) {
  for (const int k : graph.landmarks[index(landmark)].intervals) {
    if (!span.overlaps(graph.states[index(k - 1)].t, graph.states[index(k)].t)) continue;
    const GpInterval interval = graph.interval(k);
    for (const Observation& z : graph.intervals[index(k)].of(landmark)) visit(interval, z);
  }
}

/// Whitened residuals of the problem's factors.
/// Behind the camera both components are 2 fx/σ, constant.
Vector2 reprojection_residual(const GpInterval& interval, const Vector3& landmark, const Observation& z,
                              const PinholeCamera& camera);
Vector6 residual(const PosePrior& prior, const ControlState& state);
Vector6 residual(const VelocityPrior& prior, const ControlState& state);
/// With Singer's prior the first state's acceleration has its stationary distribution; zero without.
Vector6 initial_acceleration_residual(const FactorGraph& graph);
Vector3 residual(const LandmarkPrior& prior, const Vector3& position);  ///< zero without a prior
double residual(const ScaleAnchor& anchor, const FactorGraph& graph);   ///< zero without an anchor
/// Scales the estimate about the anchor's origin to the anchored scale.
void to_anchored_scale(FactorGraph& graph);

/// ½ Σ ρ of the observations in interval k, whose states are those of `interval`.
double measurement_cost(const FactorGraph& graph, int k, const GpInterval& interval);
/// Harmonic mean distance of the landmarks seen in interval k from state k − 1; 1 without landmarks.
double scene_distance(const FactorGraph& graph, int k);
/// Cost of interval k's expansion (FactorGraph::expansions).
double expansion_cost(const FactorGraph& graph, int k);
/// ½ Σ ρ of an interval's observations and motion prior, and of the priors on a state.
double interval_cost(const FactorGraph& graph, int k);
double state_prior_cost(const FactorGraph& graph, int state);
double mean_nearness(const FactorGraph& graph);  ///< of the scale anchor's landmarks; 0 without any

using PairVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 36, 1>;
using Matrix3xPair = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 36>;

/// Reprojection errors of some observations.
struct ErrorSum {
  double px = 0.0;  ///< of those before the camera
  int count = 0;
  int behind = 0;  ///< those with the landmark behind the camera
};

/// Sums over interval k's observations at the graph's estimate, one for each of its groups.
std::vector<ErrorSum> reprojection_errors(const FactorGraph& graph, int k);

/// Contribution of one interval to the normal equations H δ = −g, H = Σ JᵀJ, g = Σ Jᵀe. State columns are the
/// increments of state k−1, then of state k, 12 or 18 each (MotionPrior::state_size()).
struct IntervalLinearisation {
  struct Coupling {
    int landmark = 0;
    Matrix3xPair landmark_states;  ///< H(landmark, states)
    Matrix3 landmark_landmark;     ///< H(landmark, landmark)
    Vector3 gradient;              ///< g(landmark)
    ErrorSum error;
  };
  PairMatrix states;                ///< H(states, states), symmetric, complete; with the motion prior
  PairVector gradient;              ///< g(states)
  std::vector<Coupling> couplings;  ///< one for each landmark observed in the interval, by landmark
  double cost = 0.0;                ///< ½ Σ ρ
};

/// Everything on which an interval's factors depend.
struct IntervalInput {
  const PinholeCamera& camera;
  const RobustLoss& loss;
  const MotionPrior& motion_prior;
  const Vector6& qc;
  double expansion;
  const ControlState& state0;
  const ControlState& state1;
  const IntervalObservations& observations;
  std::span<const Vector3> positions;  ///< of the landmark of each group in observations
};

/// Linearises all observations in the interval and its motion prior; nothing is allocated once `result` has grown to
/// the number of landmarks.
void linearise_interval(const IntervalInput& in, IntervalLinearisation& result);

/// The same for interval k (1 ≤ k) of a graph at its estimate.
void linearise_interval(const FactorGraph& graph, int k, IntervalLinearisation& result);

/// H and g of the priors on one state, linearised at the graph's estimate or at x.
struct StateSystem {
  StateMatrix H;
  StateVector g;
};
StateSystem state_priors(const FactorGraph& graph, int state);
StateSystem state_priors(const FactorGraph& graph, int state, const ControlState& x);

/// The scale anchor's whitened residual and its derivative with respect to each of its landmarks, in their order.
struct AnchorLinearisation {
  double e = 0.0;
  std::vector<Vector3> jacobian;
};
AnchorLinearisation linearise_anchor(const FactorGraph& graph);

}  // namespace evbench::smoother
