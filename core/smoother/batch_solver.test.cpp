#include "core/smoother/batch_solver.hpp"

#include <Eigen/LU>

#include "core/smoother/cost.hpp"
#include "core/smoother/factors.hpp"
#include "core/smoother/problem_graph.hpp"
#include "core/support/index.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"
#include "core/testing/differences.hpp"

namespace evbench::smoother {
namespace {

/// A camera that moves past a few points; the initial estimate has errors of this size.
FactorGraph simulated_problem(int states, double error) {
  evbench::testing::RandomTangents random;
  FactorGraph graph;
  graph.camera = {200.0, 200.0, 120.0, 90.0};
  graph.qc.setConstant(0.5);
  ControlState truth;
  truth.velocity << 0.1, -0.05, 0.2, 0.5, 0.1, 0.0;
  std::vector<ControlState> motion;
  for (int i = 0; i < states; ++i) {
    motion.push_back(truth);
    truth = {truth.t + 0.05, truth.T * se3::exp(0.05 * truth.velocity), truth.velocity};
  }
  for (const ControlState& state : motion) {
    const Vector12 off = state.t == 0.0 ? Vector12::Zero() : Vector12(error * Vector12::Random());
    graph.add_state(state.retract(off));
  }
  graph.pose_priors.push_back({0, motion[0].T, Vector6::Constant(1e-3)});
  for (int j = 0; j < 12; ++j) {
    const Vector3 point(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(2, 4));
    const int landmark = graph.add_landmark(point + error * Vector3::Random(), {point, 1.0});
    for (int i = 1; i < states; ++i) {
      const double t = motion[index(i)].t - 0.02;
      const SE3 T = GpInterval(motion[index(i) - 1], motion[index(i)]).pose(t);
      const Vector2 noise(0.3 * random.direction().x(), 0.3 * random.direction().y());
      graph.add_observation(landmark, {t, graph.camera.project(T.inverse() * point) + noise, 2.0});
    }
  }
  return graph;
}

double solved_cost(const std::string& path) {
  FactorGraph graph = to_graph(read_problem(path));
  const BatchSummary summary = solve_batch(graph, {20, 1e-9});
  CHECK(summary.failure.empty());
  CHECK(summary.final_cost == Approx(evaluate(graph).total()));
  return summary.final_cost;
}

}  // namespace

TEST_CASE("The batch solve reaches the small problem's documented optimum") {
  if (const auto path = evbench::testing::problem_file("small.txt.gz"))
    CHECK(solved_cost(*path) == Approx(13981.638).margin(0.01));
}

TEST_CASE("The batch solve reaches the medium problem's documented optimum, or a lower one", "[slow]") {
  if (const auto path = evbench::testing::problem_file("medium.txt.gz")) {
    const double cost = solved_cost(*path);
    CHECK(cost <= 127925.660 + 0.01);
    CHECK(cost > 127925.0);
  }
}

TEST_CASE("A solve never raises the cost and converges from far away") {
  FactorGraph graph = simulated_problem(20, 0.15);
  const double before = evaluate(graph).total();
  const BatchSummary summary = solve_batch(graph, {50, 1e-10});
  CHECK(summary.converged);
  CHECK(summary.initial_cost == Approx(before));
  CHECK(summary.final_cost < 0.01 * before);
  FactorGraph again = graph;
  CHECK(solve_batch(again, {5, 1e-10}).final_cost <= summary.final_cost);
}

TEST_CASE("Marginal covariances equal those of the dense inverse") {
  FactorGraph graph = simulated_problem(5, 0.01);
  solve_batch(graph, {20, 1e-12});
  constexpr int kStates = 5, kLandmarks = 12, kSize = 12 * kStates + 3 * kLandmarks;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(kSize, kSize);
  IntervalLinearisation linear;
  for (int k = 1; k < kStates; ++k) {
    linearise_interval(graph, k, linear);
    H.block<24, 24>(12 * (k - 1), 12 * (k - 1)) += linear.states;
    for (const auto& coupling : linear.couplings) {
      const int l = 12 * kStates + 3 * coupling.landmark;
      H.block<3, 3>(l, l) += coupling.landmark_landmark;
      H.block<3, 24>(l, 12 * (k - 1)) += coupling.landmark_states;
      H.block<24, 3>(12 * (k - 1), l) += coupling.landmark_states.transpose();
    }
  }
  H.topLeftCorner<12, 12>() += state_priors(graph, 0).H;
  H.bottomRightCorner<3 * kLandmarks, 3 * kLandmarks>().diagonal().array() += 1.0;  // landmark priors
  const Eigen::MatrixXd inverse = H.inverse();
  const BatchCovariance covariance(graph);
  const auto pair = covariance.neighbours(2);
  REQUIRE(pair);
  CHECK((*pair - inverse.block<24, 24>(24, 24)).norm() < 1e-8 * inverse.norm());
  const auto landmark = covariance.landmark(7);
  REQUIRE(landmark);
  CHECK((*landmark - inverse.block<3, 3>(12 * kStates + 21, 12 * kStates + 21)).norm() < 1e-8 * inverse.norm());
  const auto at_state = covariance.at(graph.states[3].t);
  REQUIRE(at_state);
  CHECK((*at_state - inverse.block<12, 12>(36, 36)).norm() < 1e-8 * inverse.norm());
  CHECK_FALSE(covariance.at(-1.0));
}

TEST_CASE("A problem without gauge leaves the estimate finite") {
  FactorGraph graph = simulated_problem(5, 0.0);
  graph.pose_priors.clear();
  for (auto& landmark : graph.landmarks) landmark.prior = {};
  const BatchSummary summary = solve_batch(graph, {5, 1e-6});
  for (const ControlState& state : graph.states) CHECK(state.T.p.allFinite());
  CHECK(std::isfinite(summary.final_cost));
}

}  // namespace evbench::smoother
