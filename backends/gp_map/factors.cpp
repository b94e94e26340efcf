#include "backends/gp_map/factors.hpp"

#include <algorithm>
#include <cmath>

#include "core/motion/wnoa.hpp"

namespace evbench::gp_map {

Vector2 reprojection_residual(const GpInterval& interval, const Vector3& landmark, const Observation& z,
                              const PinholeCamera& camera) {
  const Vector3 q = interval.pose(z.t).inverse() * landmark;
  if (!(q.z() > 0.0)) return Vector2::Constant(2.0 * camera.fx * z.inverse_sigma);
  return z.inverse_sigma * (camera.project(q) - z.pixel);
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

void add_state_priors(const FactorGraph& graph, int state, Matrix12& H, Vector12& g) {
  add_state_priors(graph, state, graph.states[static_cast<std::size_t>(state)], H, g);
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

double interval_cost(const FactorGraph& graph, int k) {
  const auto index = static_cast<std::size_t>(k);
  const GpInterval interval(graph.states[index - 1], graph.states[index]);
  double cost = motion_prior_cost(interval, graph.qc);
  const IntervalObservations& observations = graph.intervals[index];
  for (const auto& group : observations.groups()) {
    const Vector3 landmark = graph.landmarks[static_cast<std::size_t>(group.landmark)].position;
    for (int i = group.begin; i < group.end; ++i) {
      const Observation& z = observations.all()[static_cast<std::size_t>(i)];
      cost += 0.5 * graph.loss.value(reprojection_residual(interval, landmark, z, graph.camera).squaredNorm());
    }
  }
  return cost;
}

double state_prior_cost(const FactorGraph& graph, int state) {
  const ControlState& x = graph.states[static_cast<std::size_t>(state)];
  double cost = 0.0;
  for (const PosePrior& prior : graph.pose_priors) {
    if (prior.state == state) cost += 0.5 * residual(prior, x).squaredNorm();
  }
  for (const VelocityPrior& prior : graph.velocity_priors) {
    if (prior.state == state) cost += 0.5 * residual(prior, x).squaredNorm();
  }
  return cost;
}

namespace {

/// Calls visit(interval, observation) for each of a landmark's observations.
template <class Visit>
void for_each_observation(const FactorGraph& graph, int landmark, Visit visit) {
  for (const int k : graph.landmarks[static_cast<std::size_t>(landmark)].intervals) {
    const auto index = static_cast<std::size_t>(k);
    const GpInterval interval(graph.states[index - 1], graph.states[index]);
    const auto& groups = graph.intervals[index].groups();
    const auto group = std::ranges::lower_bound(groups, landmark, {}, &IntervalObservations::Group::landmark);
    for (int i = group->begin; i < group->end; ++i) {
      visit(interval, graph.intervals[index].all()[static_cast<std::size_t>(i)]);
    }
  }
}

}  // namespace

double landmark_cost(const FactorGraph& graph, int landmark, const Vector3& position) {
  const LandmarkPrior& prior = graph.landmarks[static_cast<std::size_t>(landmark)].prior;
  double cost = 0.5 * residual(prior, position).squaredNorm();
  for_each_observation(graph, landmark, [&](const GpInterval& interval, const Observation& z) {
    cost += 0.5 * graph.loss.value(reprojection_residual(interval, position, z, graph.camera).squaredNorm());
  });
  return cost;
}

LandmarkSystem linearise_landmark(const FactorGraph& graph, int landmark, const Vector3& position) {
  const LandmarkPrior& prior = graph.landmarks[static_cast<std::size_t>(landmark)].prior;
  LandmarkSystem system;
  if (std::isfinite(prior.sigma)) {
    system.H.diagonal().setConstant(1.0 / (prior.sigma * prior.sigma));
    system.g = (position - prior.position) / (prior.sigma * prior.sigma);
  }
  for_each_observation(graph, landmark, [&](const GpInterval& interval, const Observation& z) {
    const SE3 T = interval.pose(z.t).inverse();
    const Vector3 q = T * position;
    if (!(q.z() > 0.0)) return;
    const Vector2 e = z.inverse_sigma * (graph.camera.project(q) - z.pixel);
    const Matrix23 J = z.inverse_sigma * graph.camera.project_jacobian(q) * T.R();
    const double weight = graph.loss.weight(e.squaredNorm());
    system.H += weight * J.transpose() * J;
    system.g += weight * J.transpose() * e;
  });
  return system;
}

double mean_log_distance(const FactorGraph& graph) {
  if (graph.anchor.landmarks.empty()) return 0.0;
  double sum = 0.0;
  for (const int j : graph.anchor.landmarks) {
    sum += std::log((graph.landmarks[static_cast<std::size_t>(j)].position - graph.anchor.origin).norm());
  }
  return sum / static_cast<double>(graph.anchor.landmarks.size());
}

AnchorLinearisation linearise_anchor(const FactorGraph& graph) {
  AnchorLinearisation result;
  const ScaleAnchor& anchor = graph.anchor;
  result.e = (mean_log_distance(graph) - anchor.mean_log_distance) / anchor.sigma;
  const double share = 1.0 / (anchor.sigma * static_cast<double>(anchor.landmarks.size()));
  for (const int j : anchor.landmarks) {
    const Vector3 from_origin = graph.landmarks[static_cast<std::size_t>(j)].position - anchor.origin;
    result.jacobian.push_back(share * from_origin / from_origin.squaredNorm());
  }
  return result;
}

}  // namespace evbench::gp_map
