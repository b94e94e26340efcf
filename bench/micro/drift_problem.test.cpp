#include "bench/micro/drift_problem.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "bench/micro/track_noise.hpp"
#include "core/motion/wnoa.hpp"
#include "core/simulation/random.hpp"
#include "core/simulation/track_wander.hpp"
#include "core/support/index.hpp"
#include "core/testing/catch2.hpp"

namespace evbench {
namespace {

using smoother::BatchOptions;
using smoother::FactorGraph;
using smoother::RobustLoss;

constexpr int kStates = 21;
constexpr double kInterval = 0.05, kSigma = 0.1;  ///< [s], [px]
constexpr BatchOptions kExactly{30, 1e-12};

struct Drawn {
  FactorGraph graph;
  std::vector<ControlState> truth;
};

/// A simulated sequence past known points, drawn from its prior, observed 80 times a second with noise in units of
/// kSigma.
Drawn draw(const TrackNoise& noise, std::uint64_t seed) {
  Random random(seed);
  const auto normal = [&](auto vector) {
    for (double& component : vector) component = random.normal();
    return vector;
  };
  Drawn result;
  FactorGraph& graph = result.graph;
  graph.camera = {200.0, 200.0, 120.0, 90.0};
  graph.qc.setConstant(0.01);
  const Matrix12 root = wnoa::process_covariance(kInterval, graph.qc).llt().matrixL();
  ControlState state;
  state.velocity << 0.0, 0.0, 0.0, 0.5, 0.1, 0.0;
  graph.pose_priors.push_back({0, state.T, Vector6::Constant(1e-5)});
  graph.velocity_priors.push_back({0, state.velocity, Vector6::Constant(0.05)});
  state.velocity += 0.05 * normal(Vector6());
  for (int i = 0; i < kStates; ++i) {
    result.truth.push_back(state);
    graph.add_state(state);
    const Vector12 local = root * normal(Vector12());  // added to (Δt ϖ, ϖ) in the tangent space of this state
    const Vector6 xi = kInterval * state.velocity + local.head<6>();
    const Vector6 rate = state.velocity + local.tail<6>();
    state = {state.t + kInterval, state.T * se3::exp(xi), se3::right_jacobian(xi) * rate};
  }
  const double end = result.truth.back().t;
  for (int j = 0; j < 15; ++j) {
    const Vector3 point = random.uniform3({-1, -1, 2}, {1, 1, 4});
    const int landmark = graph.add_landmark(point, {point + 0.02 * normal(Vector3()), 0.02});
    std::vector<TrackObservation> track;
    for (double t = 0.001; t < end; t += 0.0125) {
      const int k = graph.interval_of(t);
      const SE3 T = GpInterval(result.truth[index(k - 1)], result.truth[index(k)]).pose(t);
      track.push_back({0, t, graph.camera.project(T.inverse() * point), kSigma});
    }
    add_wander(track, kSigma * noise.drift, noise.time, Random(seed, 1 + static_cast<std::uint64_t>(j)));
    for (const TrackObservation& z : track) {
      graph.add_observation(landmark, {z.t, z.pixel + kSigma * noise.white * normal(Vector2()), 1.0 / kSigma});
    }
  }
  return result;
}

RobustLoss gaussian(double sigma) { return {RobustLoss::Kind::none, 1.0, 1.0 / (sigma * sigma)}; }

/// Mean squared error of the newest state's pose relative to the first one's, by its covariance, over 6.
double normalised_error(const TrackNoise& noise, double white, const DriftModel& model) {
  constexpr int kDraws = 60;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    Drawn drawn = draw(noise, seed);
    drawn.graph.loss = gaussian(white);
    DriftProblem problem(drawn.graph, model);
    REQUIRE(problem.solve(kExactly).failure.empty());
    const auto covariance = DriftCovariance(problem).relative(0, kStates - 1);
    REQUIRE(covariance);
    const auto between = [](const std::vector<ControlState>& s) { return s.front().T.inverse() * s.back().T; };
    const Vector6 e = se3::log(between(problem.graph().states).inverse() * between(drawn.truth));
    sum += e.dot(covariance->llt().solve(e)) / 6.0;
  }
  return sum / kDraws;
}

}  // namespace

TEST_CASE("Errors agree with the covariance of the true model, and exceed that of a model without drift") {
  const TrackNoise noise{0.4, 1.0, 0.3};
  CHECK(normalised_error(noise, 0.4, {1.0, 0.0, 0.3}) == Approx(1.0).epsilon(0.2));
  CHECK(normalised_error(noise, std::hypot(0.4, 1.0), {}) > 2.0);
}

TEST_CASE("Offsets with zero variance change nothing") {
  Drawn drawn = draw({1.0, 0.0, 0.3}, 1);
  drawn.graph.loss = RobustLoss(RobustLoss::Kind::cauchy, 2.0);
  FactorGraph white = drawn.graph;
  smoother::solve_batch(white, kExactly);
  for (const DriftModel& model : {DriftModel{1e-6, 0.0, 0.3}, DriftModel{1e-6, 0.1, 0.3}, DriftModel{1e-6, 0.1, 0.0},
                                  DriftModel{1e-6, std::numeric_limits<double>::infinity(), 0.0}, DriftModel{}}) {
    DriftProblem problem(drawn.graph, model);
    problem.solve(kExactly);
    for (std::size_t i = 0; i < white.states.size(); ++i) {
      CHECK(se3::log(white.states[i].T.inverse() * problem.graph().states[i].T).norm() < 1e-6);
    }
  }
}

TEST_CASE("The gradient of a problem with offsets is that of its cost") {
  Drawn drawn = draw({0.4, 1.0, 0.3}, 2);
  drawn.graph.loss = RobustLoss(RobustLoss::Kind::cauchy, 0.8, 1.0 / 0.16);
  DriftProblem problem(drawn.graph, {1.0, 0.08, 0.3});
  problem.solve({2, 0.0});  // offsets other than zero
  const Eigen::VectorXd gradient = problem.linearise().gradient();
  Random random(3);
  const auto before = problem.estimate();
  for (int n = 0; n < 20; ++n) {
    Eigen::VectorXd direction(problem.unknowns());
    for (double& component : direction) component = 1e-6 * random.normal();
    const auto cost_at = [&](double step) {
      problem.apply(step * direction);
      const double cost = problem.cost();
      problem.restore(before);
      return cost;
    };
    const double slope = 0.5 * (cost_at(1.0) - cost_at(-1.0));
    CHECK(slope == Approx(gradient.dot(direction)).epsilon(1e-3).margin(1e-5));
  }
}

TEST_CASE("White and drifting noise are distinguished by residuals") {
  for (const TrackNoise& noise : {TrackNoise{0.5, 1.0, 0.2}, TrackNoise{1.0, 0.0, 0.3}}) {
    const TrackNoise found = estimate_noise(draw(noise, 1).graph);
    CAPTURE(noise.drift, found.white, found.drift, found.time);
    CHECK(found.white == Approx(noise.white).epsilon(0.2));
    CHECK(found.drift == Approx(noise.drift).epsilon(0.2).margin(0.35));
  }
}

}  // namespace evbench
