#include "backends/gp_map/testing/ambiguous_sequence.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

#include "core/simulation/random.hpp"
#include "core/smoother/factors.hpp"
#include "core/smoother/smoother.hpp"

namespace evbench::gp_map::ambiguous_sequence {

FactorGraph simulate_problem(const CameraMotion& motion, std::uint64_t seed, bool tentative, int states) {
  Random random(seed);
  FactorGraph graph;
  graph.camera = {200.0, 200.0, 120.0, 90.0};
  graph.qc = Vector6::Constant(0.1);
  graph.loss = RobustLoss(RobustLoss::Kind::cauchy, 2.0);
  ControlState state;
  for (int i = 0; i < states; ++i) {
    const double t = kStep * i;
    state.t = t;
    state.velocity << 0.0, t < 2.0 ? motion.turn : -motion.turn, 0.0, 0.4 - 0.2 * t, 0.1 * t, motion.ahead;
    graph.add_state(state);
    state.T = state.T * se3::exp(kStep * state.velocity);
  }
  const int landmarks = kLandmarks + (kLandmarks - kOld) * (states - kStates) / static_cast<int>(1.4 / kStep);
  for (int j = 0; j < landmarks; ++j) {
    const double from = j < kOld ? 0.25 : 0.45 + 1.4 * (j - kOld) / (kLandmarks - kOld);
    const auto pose = [&](double t) {
      const int k = graph.interval_of(t);
      return graph.interval(k).pose(t);
    };
    const SE3 T = pose(from);
    const Vector3 ray = T.R() * graph.camera.ray({random.uniform(20.0, 220.0), random.uniform(20.0, 160.0)});
    const Vector3 normal(-0.6, 0.0, 1.0);  // of the plane z = 2 + 0.6 x
    const Vector3 point = T.p + (2.0 - normal.dot(T.p)) / normal.dot(ray) * ray;
    const int landmark = graph.add_landmark(point);
    const double until = std::min(from + (j < kOld ? 0.5 : 0.8), kStep * (states - 1));
    for (double t = from + 0.5 * kStep; t < until; t += 0.5 * kStep) {
      const Vector3 q = pose(t).inverse() * point;
      const Vector2 pixel = graph.camera.project(q) + kSigma * random.normal2();
      graph.add_observation(landmark, {t, pixel, 1.0 / kSigma});
    }
  }
  graph.pose_priors.push_back({0, graph.states.front().T, Vector6::Constant(1e-4)});
  if (tentative) {
    std::vector<int> first(kOld);
    std::iota(first.begin(), first.end(), 0);
    graph.anchor_scale(graph.states.front().T.p, first);
    return graph;
  }
  for (int j = 0; j < kOld; ++j) graph.landmarks[index(j)].prior = {graph.landmarks[index(j)].position, 1e-3};
  return graph;
}

FactorGraph misled(FactorGraph graph) {
  const Vector3 across = (graph.states.back().T.p - graph.states.front().T.p).normalized();
  for (int j = kOld; j < std::ssize(graph.landmarks); ++j) {
    FactorGraph::Landmark& landmark = graph.landmarks[index(j)];
    if (landmark.intervals.empty()) continue;
    const Vector3& p = graph.states[index(landmark.intervals.front())].T.p;
    const Vector3 ray = landmark.position - p;
    landmark.position = p + across.dot(Vector3(0.4, 0.0, 2.24) - p) / across.dot(ray) * ray;
    landmark.prior = {landmark.position, 0.02};
  }
  Smoother smoother(std::move(graph), {});
  smoother.optimise(20, 1e-6);
  for (int j = kOld; j < std::ssize(smoother.graph().landmarks); ++j) smoother.remove_prior(j);
  smoother.optimise(50, 1e-9);
  return smoother.graph();
}

FactorGraph solved(FactorGraph graph) {
  Smoother smoother(std::move(graph), {});
  smoother.optimise(20, 1e-9);
  return smoother.graph();
}

double cost(const FactorGraph& graph) { return evaluate(graph).total(); }

}  // namespace evbench::gp_map::ambiguous_sequence
