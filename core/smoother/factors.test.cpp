#include "core/smoother/factors.hpp"

#include <cmath>
#include <numeric>

#include "core/smoother/cost.hpp"
#include "core/support/index.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/differences.hpp"

namespace evbench::smoother {
namespace {

using evbench::testing::central_differences;
using evbench::testing::RandomTangents;
using evbench::testing::relative_error;

constexpr MotionPrior kWnoa, kSinger{15.0};

/// Two states a moderate motion apart and landmarks in front of them, observed at random times with errors.
FactorGraph random_interval(RandomTangents& random, int i, int landmarks, const MotionPrior& prior = kWnoa) {
  FactorGraph graph;
  graph.motion_prior = prior;
  graph.camera = {200.0, 210.0, 120.0, 90.0};
  graph.qc << 0.1, 0.2, 0.3, 1.0, 2.0, 3.0;
  ControlState a;
  a.t = random.uniform(0.0, 10.0);
  a.T = random.pose();
  a.velocity << random.uniform(0, 2) * random.direction(), random.uniform(0, 2) * random.direction();
  Vector6 step;
  step << (i % 4 == 0 ? 0.0 : random.uniform(0.0, 0.4)) * random.direction(),
      random.uniform(0, 0.3) * random.direction();
  ControlState b;
  b.t = a.t + random.uniform(0.02, 0.2);
  b.T = a.T * se3::exp(step);
  b.velocity << random.uniform(0, 2) * random.direction(), random.uniform(0, 2) * random.direction();
  if (prior.has_acceleration()) {
    for (ControlState* state : {&a, &b}) {
      state->acceleration << random.uniform(0, 9) * random.direction(), random.uniform(0, 9) * random.direction();
    }
  }
  graph.add_state(a);
  graph.add_state(b);
  for (int j = 0; j < landmarks; ++j) {
    const Vector3 point = a.T * Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(2, 5));
    const int landmark = graph.add_landmark(point);
    for (int n = 0; n < 3; ++n) {
      const double t = n == 2 ? b.t : a.t + random.uniform(0.0, 1.0) * (b.t - a.t);
      const Whitening whitening(random.uniform(0.5, 2.0), random.uniform(-1.0, 1.0), random.uniform(0.5, 2.0));
      graph.add_observation(landmark, {t, {random.uniform(0, 240), random.uniform(0, 180)}, whitening});
    }
  }
  return graph;
}

/// All whitened residuals of the interval, and their derivative: H = JᵀJ, g = Jᵀe by the definition.
template <class Vector>
Eigen::VectorXd residuals(const FactorGraph& graph, const Vector& states, const Eigen::VectorXd& landmarks) {
  const Eigen::Index n = graph.state_size();
  const GpInterval interval(graph.states[0].retract(states.head(n)), graph.states[1].retract(states.tail(n)),
                            graph.motion_prior);
  std::vector<double> values;
  for (const auto& group : graph.intervals[1].groups()) {
    const Vector3 point = graph.landmarks[index(group.landmark)].position + landmarks.segment<3>(3 * group.landmark);
    for (int i = group.begin; i < group.end; ++i) {
      const Vector2 e = reprojection_residual(interval, point, graph.intervals[1].all()[index(i)], graph.camera);
      values.push_back(e.x());
      values.push_back(e.y());
    }
  }
  return Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

template <int Orders>
void check_normal_equations(const MotionPrior& motion_prior) {
  constexpr int kPair = 12 * Orders;
  using Pair = Eigen::Matrix<double, kPair, 1>;
  RandomTangents random;
  constexpr int kSeen = 2;
  constexpr int kRows = 2 * 3 * kSeen;
  for (int i = 0; i < 500; ++i) {
    const FactorGraph graph = random_interval(random, i, kSeen, motion_prior);
    const auto J_states = central_differences<kRows, kPair>([&](const Pair& d) -> Eigen::Matrix<double, kRows, 1> {
      return residuals(graph, d, Eigen::VectorXd::Zero(3 * kSeen));
    });
    const auto J_landmarks = central_differences<kRows, 3 * kSeen>(
        [&](const Vector6& d) -> Eigen::Matrix<double, kRows, 1> { return residuals(graph, Pair(Pair::Zero()), d); });
    const Eigen::VectorXd e = residuals(graph, Pair(Pair::Zero()), Eigen::VectorXd::Zero(3 * kSeen));
    const GpInterval interval = graph.interval(1);
    const auto prior = interval.prior_jacobians(interval.derivatives());
    Eigen::Matrix<double, kPair / 2, kPair> J_prior;
    J_prior << prior.J0, prior.J1;
    const Eigen::MatrixXd axis = interval.prior_information_of_axis();
    Eigen::Matrix<double, kPair / 2, kPair / 2> W = decltype(W)::Zero();
    for (int r = 0; r < Orders; ++r) {
      for (int c = 0; c < Orders; ++c) {
        W.template block<6, 6>(6 * r, 6 * c).diagonal() = axis(r, c) * graph.qcs[1].cwiseInverse();
      }
    }

    IntervalLinearisation linear;
    linearise_interval(graph, 1, linear);
    const Eigen::MatrixXd H = J_states.transpose() * J_states + J_prior.transpose() * W * J_prior;
    const Pair g = J_states.transpose() * e + J_prior.transpose() * W * interval.prior_residual();
    CHECK(relative_error(linear.states, H) < 1e-6);
    CHECK(relative_error(linear.gradient, g) < 1e-6);
    const Vector6 acceleration = initial_acceleration_residual(graph);
    CHECK(linear.cost + 0.5 * acceleration.squaredNorm() == Approx(evaluate(graph).total()));
    REQUIRE(linear.couplings.size() == kSeen);
    for (const auto& coupling : linear.couplings) {
      const Eigen::Matrix<double, kRows, 3> J = J_landmarks.template middleCols<3>(3 * coupling.landmark);
      CHECK(relative_error(coupling.landmark_landmark, J.transpose() * J) < 1e-6);
      CHECK(relative_error(coupling.landmark_states, J.transpose() * J_states) < 1e-6);
      CHECK(relative_error(coupling.gradient, J.transpose() * e) < 1e-6);
      const double mean = reprojection_mean(graph, coupling.landmark);
      CHECK(coupling.error.count == static_cast<int>(graph.intervals[1].of(coupling.landmark).size()));
      if (coupling.error.behind == 0) CHECK(coupling.error.px == Approx(mean * coupling.error.count));
      CHECK((coupling.error.behind > 0) == std::isinf(mean));
    }
  }
}

}  // namespace

TEST_CASE("An interval's normal equations equal those of central differences of its residuals") {
  check_normal_equations<2>(kWnoa);
  check_normal_equations<3>(kSinger);
}

TEST_CASE("An interval's cost and reprojection errors are the sums over its observations, for any rotation") {
  RandomTangents random;
  for (int i = 0; i < 200; ++i) {
    FactorGraph graph = random_interval(random, i, 1 + i % 9, i % 4 < 2 ? kWnoa : kSinger);
    graph.loss = RobustLoss(static_cast<RobustLoss::Kind>(i % 3), 2.0);
    if (i % 2 == 0) graph.states[1].T = graph.states[0].T * se3::exp(random.tangent(i));
    const GpInterval interval = graph.interval(1);
    const std::vector<ErrorSum> errors = reprojection_errors(graph, 1);
    const auto& groups = graph.intervals[1].groups();
    REQUIRE(errors.size() == groups.size());
    double cost = 0.0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const Vector3& point = graph.landmarks[index(groups[g].landmark)].position;
      ErrorSum expected;
      for (const Observation& z : graph.intervals[1].of(groups[g])) {
        cost += 0.5 * graph.loss.value(reprojection_residual(interval, point, z, graph.camera).squaredNorm());
        const double error = reprojection_error(interval, point, z, graph.camera);
        ++expected.count;
        std::isfinite(error) ? expected.px += error : ++expected.behind;
      }
      CHECK(errors[g].px == Approx(expected.px).epsilon(1e-9));
      CHECK(errors[g].count == expected.count);
      CHECK(errors[g].behind == expected.behind);
    }
    CHECK(measurement_cost(graph, 1, interval) == Approx(cost).epsilon(1e-9));
  }
}

TEST_CASE("Gradients of robust losses and of state priors match the cost") {
  RandomTangents random;
  for (int i = 0; i < 100; ++i) {
    FactorGraph graph = random_interval(random, i, 3, kSinger);
    graph.loss = RobustLoss(i % 2 == 0 ? RobustLoss::Kind::huber : RobustLoss::Kind::cauchy, 1.5);
    const SE3 near = graph.states[1].T * se3::exp(Vector6::Constant(0.1));
    graph.pose_priors.push_back({1, near, Vector6::LinSpaced(0.1, 0.6)});
    graph.velocity_priors.push_back({1, Vector6::Constant(0.3), Vector6::LinSpaced(0.1, 0.6)});
    IntervalLinearisation linear;
    linearise_interval(graph, 1, linear);
    using Vector36 = Eigen::Matrix<double, 36, 1>;
    Vector36 gradient = linear.gradient;
    gradient.head<18>() += state_priors(graph, 0).g;
    gradient.tail<18>() += state_priors(graph, 1).g;
    const auto slope = central_differences<1, 36>(
        [&](const Vector36& d) -> Eigen::Matrix<double, 1, 1> {
          FactorGraph moved = graph;
          moved.states[0] = graph.states[0].retract(d.head<18>());
          moved.states[1] = graph.states[1].retract(d.tail<18>());
          return Eigen::Matrix<double, 1, 1>(evaluate(moved).total());
        },
        1e-4);
    CHECK(relative_error(gradient, slope.transpose().eval()) < 1e-6);
  }
}

TEST_CASE("The scale anchor's derivative equals central differences") {
  RandomTangents random;
  for (int i = 0; i < 100; ++i) {
    FactorGraph graph = random_interval(random, i, 2);
    graph.anchor_scale(Vector3(0.1, 0.2, 0.3), {0, 1});
    graph.anchor.sigma = 0.1;
    graph.landmarks[0].position *= 1.1;
    const auto slope = central_differences<1, 6>([&](const Vector6& d) -> Eigen::Matrix<double, 1, 1> {
      FactorGraph moved = graph;
      moved.landmarks[0].position += d.head<3>();
      moved.landmarks[1].position += d.tail<3>();
      return Eigen::Matrix<double, 1, 1>(linearise_anchor(moved).e);
    });
    Vector6 jacobian;
    jacobian << linearise_anchor(graph).jacobian[0], linearise_anchor(graph).jacobian[1];
    CHECK(relative_error(jacobian, slope.transpose().eval()) < 1e-6);
  }
}

TEST_CASE("Removing an anchor's landmark leaves the scale unchanged") {
  RandomTangents random;
  FactorGraph graph = random_interval(random, 1, 3);
  graph.anchor_scale(Vector3::Zero(), {0, 1, 2});
  graph.remove_landmark(1);
  CHECK(graph.anchor.landmarks == std::vector<int>{0, 2});
  CHECK(linearise_anchor(graph).e == Approx(0.0).margin(1e-9));
}

TEST_CASE("A landmark's scale of sigmas applies to future observations, and can be undone") {
  FactorGraph graph;
  graph.add_state({0.0, {}, Vector6::Zero()});
  graph.add_state({1.0, {}, Vector6::Zero()});
  const int j = graph.add_landmark({0.0, 0.0, 1.0});
  const auto inverse_sigma = [&](std::size_t i) { return graph.intervals[1].of(j)[i].whitening.inverse_sigma(); };
  REQUIRE(graph.add_observation(j, {0.3, {1.0, 2.0}, 4.0}));
  graph.scale_sigmas(j, 2.0);
  REQUIRE(graph.add_observation(j, {0.6, {1.0, 2.0}, 4.0}));
  CHECK(inverse_sigma(0) == 2.0);
  CHECK(inverse_sigma(1) == 2.0);
  graph.scale_sigmas(j, 1.0);
  CHECK(inverse_sigma(0) == 4.0);
  CHECK(inverse_sigma(1) == 4.0);
}

TEST_CASE("The scale anchor measures changes of the scale's logarithm, little affected by one landmark that runs off") {
  RandomTangents random;
  constexpr int kLandmarks = 20;
  FactorGraph graph = random_interval(random, 1, kLandmarks);
  std::vector<int> all(kLandmarks);
  std::iota(all.begin(), all.end(), 0);
  graph.anchor_scale(Vector3::Zero(), all);
  constexpr double kChange = 1e-3;
  FactorGraph larger = graph;
  for (auto& landmark : larger.landmarks) landmark.position *= 1.0 + kChange;
  CHECK(linearise_anchor(larger).e * graph.anchor.sigma == Approx(kChange).epsilon(0.01));
  for (const double far : {1e-9, 1e9}) {
    FactorGraph without = graph;
    without.landmarks[3].position *= far;
    CHECK(std::abs(linearise_anchor(without).e * graph.anchor.sigma) < 3.0 / kLandmarks);
    CHECK(std::isfinite(linearise_anchor(without).jacobian[3].norm()));
  }
}

TEST_CASE("An observation behind the camera has a constant cost and no gradient") {
  RandomTangents random;
  FactorGraph graph = random_interval(random, 1, 1);
  graph.landmarks[0].position = graph.states[0].T * Vector3(0, 0, -3);
  IntervalLinearisation linear;
  linearise_interval(graph, 1, linear);
  CHECK(linear.couplings[0].landmark_landmark.norm() == 0.0);
  double expected = 0.0;  // half the square of two residuals of 2 fx/sigma
  for (const Observation& z : graph.intervals[1].all()) {
    expected += 4.0 * 200.0 * 200.0 * z.whitening.inverse_sigma() * z.whitening.inverse_sigma();
  }
  CHECK(evaluate(graph).measurements == Approx(expected));
}

TEST_CASE("An expansion's gradient is the derivative of its cost, which falls with the logarithm of the scale") {
  RandomTangents random;
  FactorGraph graph = random_interval(random, 1, 6);
  IntervalLinearisation with, without;
  linearise_interval(graph, 1, without);
  graph.expansions[1] = 3.0;
  linearise_interval(graph, 1, with);
  CHECK(with.cost - without.cost == Approx(expansion_cost(graph, 1)));
  const auto cost = [&](int variable, const Vector3& delta) {  // −1: the position of state 0
    FactorGraph moved = graph;
    Vector12 step = Vector12::Zero();
    step.segment<3>(3) = delta;
    if (variable < 0) {
      moved.states[0] = moved.states[0].retract(step);
    } else {
      moved.landmarks[index(variable)].position += delta;
    }
    return expansion_cost(moved, 1);
  };
  for (int j = -1; j < 6; ++j) {
    const Vector3 gradient = j < 0 ? Vector3(with.gradient.segment<3>(3) - without.gradient.segment<3>(3))
                                   : Vector3(with.couplings[index(j)].gradient - without.couplings[index(j)].gradient);
    for (int i = 0; i < 3; ++i) {
      const Vector3 step = 1e-5 * Vector3::Unit(i);
      CHECK(gradient[i] == Approx((cost(j, step) - cost(j, -step)) / 2e-5).margin(1e-7));
    }
  }
  FactorGraph larger = graph;
  for (auto& landmark : larger.landmarks) landmark.position *= 2.0;
  for (auto& state : larger.states) state.T.p *= 2.0;
  CHECK(expansion_cost(larger, 1) == Approx(expansion_cost(graph, 1) - 3.0 * std::log(2.0)));
}

}  // namespace evbench::smoother
