#include "core/smoother/factors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace evbench::smoother {
namespace {

Vector6 stationary_variance(const FactorGraph& graph) { return 0.5 * graph.motion_prior.rate * graph.qcs.front(); }

}  // namespace

Cost evaluate(const FactorGraph& graph) {
  Cost cost;
  for (int k = 1; k < static_cast<int>(graph.states.size()); ++k) {
    const GpInterval interval = graph.interval(k);
    cost.motion_prior += interval.prior_cost(graph.qcs[index(k)]);
    cost.motion_prior += expansion_cost(graph, k);
    cost.measurements += measurement_cost(graph, k, interval);
  }
  for (const PosePrior& prior : graph.pose_priors) {
    cost.priors += 0.5 * residual(prior, graph.states[index(prior.state)]).squaredNorm();
  }
  for (const VelocityPrior& prior : graph.velocity_priors) {
    cost.priors += 0.5 * residual(prior, graph.states[index(prior.state)]).squaredNorm();
  }
  for (const FactorGraph::Landmark& landmark : graph.landmarks) {
    if (landmark.alive) cost.priors += 0.5 * residual(landmark.prior, landmark.position).squaredNorm();
  }
  const double e = residual(graph.anchor, graph);
  cost.priors += 0.5 * e * e;
  cost.priors += 0.5 * initial_acceleration_residual(graph).squaredNorm();
  return cost;
}

double reprojection_error(const GpInterval& interval, const Vector3& landmark, const Observation& z,
                          const PinholeCamera& camera) {
  const Vector3 q = interval.pose(z.t).inverse() * landmark;
  if (!(q.z() > 0.0)) return std::numeric_limits<double>::infinity();
  return (camera.project(q) - z.pixel).norm();
}

double reprojection_mean(const FactorGraph& graph, int landmark) {
  double sum = 0.0;
  int count = 0;
  for_each_observation(graph, landmark, {}, [&](const GpInterval& interval, const Observation& z) {
    sum += reprojection_error(interval, graph.landmarks[index(landmark)].position, z, graph.camera);
    ++count;
  });
  return count == 0 ? 0.0 : sum / count;
}

Vector2 reprojection_residual(const GpInterval& interval, const Vector3& landmark, const Observation& z,
                              const PinholeCamera& camera) {
  const Vector3 q = interval.pose(z.t).inverse() * landmark;
  if (!(q.z() > 0.0)) return Vector2::Constant(2.0 * camera.fx * z.whitening.inverse_sigma());
  return z.whitening * Vector2(camera.project(q) - z.pixel);
}

Vector6 residual(const PosePrior& prior, const ControlState& state) {
  return se3::log(prior.T.inverse() * state.T).cwiseQuotient(prior.sigma);
}

Vector6 residual(const VelocityPrior& prior, const ControlState& state) {
  return (state.velocity - prior.velocity).cwiseQuotient(prior.sigma);
}

Vector6 initial_acceleration_residual(const FactorGraph& graph) {
  if (!graph.motion_prior.has_acceleration() || graph.states.empty()) return Vector6::Zero();
  return graph.states.front().acceleration.cwiseQuotient(stationary_variance(graph).cwiseSqrt());
}

Vector3 residual(const LandmarkPrior& prior, const Vector3& position) {
  if (!std::isfinite(prior.sigma)) return Vector3::Zero();
  return (position - prior.position) / prior.sigma;
}

double residual(const ScaleAnchor& anchor, const FactorGraph& graph) {
  return (anchor.mean_nearness - mean_nearness(graph)) / (anchor.change * anchor.sigma);
}

void to_anchored_scale(FactorGraph& graph) {
  constexpr int kSteps = 20;
  const Vector3 origin = graph.anchor.origin;
  for (int i = 0; i < kSteps && !graph.anchor.landmarks.empty(); ++i) {
    const double larger = graph.anchor.sigma * residual(graph.anchor, graph);  // logarithm of the scale, to first order
    const double factor = std::exp(-std::clamp(larger, -1.0, 1.0));
    for (ControlState& state : graph.states) {
      state.T.p = origin + factor * (state.T.p - origin);
      state.velocity.tail<3>() *= factor;
      state.acceleration.tail<3>() *= factor;
    }
    for (FactorGraph::Landmark& l : graph.landmarks) l.position = origin + factor * (l.position - origin);
  }
}

StateSystem state_priors(const FactorGraph& graph, int state) {
  return state_priors(graph, state, graph.states[index(state)]);
}

StateSystem state_priors(const FactorGraph& graph, int state, const ControlState& x) {
  const int n = graph.state_size();
  StateSystem system{StateMatrix::Zero(n, n), StateVector::Zero(n)};
  for (const PosePrior& prior : graph.pose_priors) {
    if (prior.state != state) continue;
    const Vector6 whiten = prior.sigma.cwiseInverse();
    const Matrix6 J = whiten.asDiagonal() * se3::right_jacobian_inverse(se3::log(prior.T.inverse() * x.T));
    system.H.topLeftCorner<6, 6>() += J.transpose() * J;
    system.g.head<6>() += J.transpose() * residual(prior, x);
  }
  for (const VelocityPrior& prior : graph.velocity_priors) {
    if (prior.state != state) continue;
    const Vector6 whiten = prior.sigma.cwiseInverse();
    system.H.block<6, 6>(6, 6).diagonal() += whiten.cwiseAbs2();
    system.g.segment<6>(6) += whiten.cwiseProduct(residual(prior, x));
  }
  if (state == 0 && graph.motion_prior.has_acceleration()) {
    const Vector6 information = stationary_variance(graph).cwiseInverse();
    system.H.bottomRightCorner<6, 6>().diagonal() += information;
    system.g.tail<6>() += information.cwiseProduct(x.acceleration);
  }
  return system;
}

double scene_distance(const FactorGraph& graph, int k) {
  const auto& groups = graph.intervals[index(k)].groups();
  double nearness = 0.0;
  for (const auto& group : groups) {
    nearness += 1.0 / (graph.landmarks[index(group.landmark)].position - graph.states[index(k - 1)].T.p).norm();
  }
  return groups.empty() ? 1.0 : static_cast<double>(groups.size()) / nearness;
}

double expansion_cost(const FactorGraph& graph, int k) {
  const double expansion = graph.expansions[index(k)];
  return expansion == 0.0 ? 0.0 : -expansion * std::log(scene_distance(graph, k));
}

double interval_cost(const FactorGraph& graph, int k) {
  const GpInterval interval = graph.interval(k);
  return interval.prior_cost(graph.qcs[index(k)]) + expansion_cost(graph, k) + measurement_cost(graph, k, interval);
}

double state_prior_cost(const FactorGraph& graph, int state) {
  const ControlState& x = graph.states[index(state)];
  double cost = 0.0;
  for (const PosePrior& prior : graph.pose_priors) {
    if (prior.state == state) cost += 0.5 * residual(prior, x).squaredNorm();
  }
  for (const VelocityPrior& prior : graph.velocity_priors) {
    if (prior.state == state) cost += 0.5 * residual(prior, x).squaredNorm();
  }
  if (state == 0) cost += 0.5 * initial_acceleration_residual(graph).squaredNorm();
  return cost;
}

double mean_nearness(const FactorGraph& graph) {
  const ScaleAnchor& anchor = graph.anchor;
  if (anchor.landmarks.empty()) return 0.0;
  double sum = 0.0;
  for (const int j : anchor.landmarks) sum += anchor.nearness(graph.landmarks[index(j)].position);
  return sum / static_cast<double>(anchor.landmarks.size());
}

AnchorLinearisation linearise_anchor(const FactorGraph& graph) {
  AnchorLinearisation result;
  const ScaleAnchor& anchor = graph.anchor;
  result.e = residual(anchor, graph);
  const double share =
      1.0 / (anchor.change * anchor.sigma * anchor.unit * static_cast<double>(anchor.landmarks.size()));
  for (const int j : anchor.landmarks) {
    const Vector3& position = graph.landmarks[index(j)].position;
    const double nearness = anchor.nearness(position);
    result.jacobian.push_back(share * nearness * nearness * (position - anchor.origin).normalized());
  }
  return result;
}

}  // namespace evbench::smoother
