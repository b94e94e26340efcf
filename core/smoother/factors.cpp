#include "core/smoother/factors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/motion/wnoa.hpp"

namespace evbench::smoother {

Cost evaluate(const FactorGraph& graph) {
  Cost cost;
  for (int k = 1; k < static_cast<int>(graph.states.size()); ++k) {
    const GpInterval interval(graph.states[index(k - 1)], graph.states[index(k)]);
    cost.motion_prior += motion_prior_cost(interval, graph.qcs[index(k)]);
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

double motion_prior_cost(const GpInterval& interval, const Vector6& qc) {
  const Vector12 e = interval.prior_residual();
  return 0.5 * e.dot(wnoa::process_information(interval.dt(), qc) * e);
}

Vector6 residual(const PosePrior& prior, const ControlState& state) {
  return se3::log(prior.T.inverse() * state.T).cwiseQuotient(prior.sigma);
}

Vector6 residual(const VelocityPrior& prior, const ControlState& state) {
  return (state.velocity - prior.velocity).cwiseQuotient(prior.sigma);
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
    }
    for (FactorGraph::Landmark& l : graph.landmarks) l.position = origin + factor * (l.position - origin);
  }
}

void add_state_priors(const FactorGraph& graph, int state, Matrix12& H, Vector12& g) {
  add_state_priors(graph, state, graph.states[index(state)], H, g);
}

void add_state_priors(const FactorGraph& graph, int state, const ControlState& x, Matrix12& H, Vector12& g) {
  for (const PosePrior& prior : graph.pose_priors) {
    if (prior.state != state) continue;
    const Vector6 whiten = prior.sigma.cwiseInverse();
    const Matrix6 J = whiten.asDiagonal() * se3::right_jacobian_inverse(se3::log(prior.T.inverse() * x.T));
    H.topLeftCorner<6, 6>() += J.transpose() * J;
    g.head<6>() += J.transpose() * residual(prior, x);
  }
  for (const VelocityPrior& prior : graph.velocity_priors) {
    if (prior.state != state) continue;
    const Vector6 whiten = prior.sigma.cwiseInverse();
    H.bottomRightCorner<6, 6>().diagonal() += whiten.cwiseAbs2();
    g.tail<6>() += whiten.cwiseProduct(residual(prior, x));
  }
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
  const GpInterval interval(graph.states[index(k - 1)], graph.states[index(k)]);
  return motion_prior_cost(interval, graph.qcs[index(k)]) + expansion_cost(graph, k) +
         measurement_cost(graph, k, interval);
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
