#include "core/smoother/problem_graph.hpp"

#include <cmath>

#include "core/support/index.hpp"

namespace evbench::smoother {

FactorGraph to_graph(const Problem& problem, const MotionPrior& motion_prior) {
  const Problem usable = prepare(problem);
  FactorGraph graph;
  graph.camera = usable.camera;
  graph.motion_prior = motion_prior;
  graph.qc = usable.qc;
  for (const ControlState& state : usable.states) graph.add_state(state);
  for (const Vector3& position : usable.landmarks) graph.add_landmark(position);
  for (auto& landmark : graph.landmarks) landmark.alive = false;
  for (const auto& z : usable.observations) {
    graph.landmarks[index(z.landmark)].alive = true;
    graph.add_observation(z.landmark, {z.t, z.pixel, z.noise.whitening()});
  }
  for (const auto& prior : usable.pose_priors) graph.pose_priors.push_back({prior.state, prior.T, prior.sigma});
  for (const auto& prior : usable.velocity_priors) {
    graph.velocity_priors.push_back({prior.state, prior.velocity, prior.sigma});
  }
  for (const auto& prior : usable.landmark_priors) {
    graph.landmarks[index(prior.landmark)].prior = {prior.position, prior.sigma};
  }
  return graph;
}

namespace {

/// The geometric mean over the intervals.
Vector6 mean_qc(const FactorGraph& graph) {
  if (graph.qcs.size() < 2) return graph.qc;
  const Vector6& first = graph.qcs[1];
  Vector6 logs = Vector6::Zero();
  for (std::size_t k = 1; k < graph.qcs.size(); ++k) logs += graph.qcs[k].cwiseQuotient(first).array().log().matrix();
  const auto intervals = static_cast<double>(graph.qcs.size() - 1);
  return first.cwiseProduct((logs / intervals).array().exp().matrix());
}

}  // namespace

Problem to_problem(const FactorGraph& graph) {
  Problem problem;
  problem.camera = graph.camera;
  problem.qc = mean_qc(graph);
  problem.states = graph.states;
  std::vector<int> number(graph.landmarks.size(), -1);
  for (std::size_t j = 0; j < graph.landmarks.size(); ++j) {
    const FactorGraph::Landmark& landmark = graph.landmarks[j];
    if (!landmark.alive) continue;
    number[j] = static_cast<int>(problem.landmarks.size());
    problem.landmarks.push_back(landmark.position);
    if (std::isfinite(landmark.prior.sigma)) {
      problem.landmark_priors.push_back({number[j], landmark.prior.position, landmark.prior.sigma});
    }
  }
  for (const int j : graph.anchor.landmarks) {
    constexpr double kShareOfDistance = 0.05;
    const Vector3& position = graph.landmarks[index(j)].position;
    const double sigma = kShareOfDistance * (position - graph.anchor.origin).norm();
    problem.landmark_priors.push_back({number[index(j)], position, sigma});
  }
  const double counted = std::sqrt(graph.loss.share());
  for (const IntervalObservations& interval : graph.intervals) {
    for (const auto& group : interval.groups()) {
      for (int i = group.begin; i < group.end; ++i) {
        const Observation& z = interval.all()[index(i)];
        problem.observations.push_back(
            {z.t, number[index(group.landmark)], z.pixel, PixelNoise::of(z.whitening.scaled(counted))});
      }
    }
  }
  for (const auto& prior : graph.pose_priors) problem.pose_priors.push_back({prior.state, prior.T, prior.sigma});
  for (const auto& prior : graph.velocity_priors) {
    problem.velocity_priors.push_back({prior.state, prior.velocity, prior.sigma});
  }
  return problem;
}

}  // namespace evbench::smoother
