#include "backends/gp_map/modules/recent_motion.hpp"

#include <limits>
#include <optional>
#include <utility>

#include "core/smoother/testing/drawn_problem.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {
namespace {

using smoother::testing::DrawnProblem;

constexpr double kDensity = 0.01;  // [rad²/s³, m²/s³]

Smoother solved_with(double qc, const DrawnProblem& problem) {
  Smoother smoother = problem.solve_incrementally();
  for (int k = 1; k < DrawnProblem::kStates; ++k) smoother.set_qc(k, Vector6::Constant(qc));
  smoother.set_next_qc(Vector6::Constant(qc));
  smoother.optimise(10, 1e-9);
  return smoother;
}

}  // namespace

TEST_CASE("The newest motion is smoothed by the prior that it shows, whichever prior it was estimated with", "[slow]") {
  // A prior that is too strong has distorted the map, which stays so.
  for (const auto& [wrong, remains] : {std::pair(100.0, 0.5), std::pair(0.01, 0.7)}) {
    double estimated = 0.0, smoothed = 0.0;  // squared errors of the newest velocity
    for (int seed = 1; seed <= 20; ++seed) {
      const DrawnProblem problem({.qc = kDensity, .pixel_sigma = 0.3}, static_cast<std::uint64_t>(seed));
      const Smoother smoother = solved_with(wrong * kDensity, problem);
      RecentMotion motion(RecentPrior(0.3, 3.0, smoother.graph().qc));
      for (int i = 0; i < 20; ++i) motion.follow(smoother.graph(), 0);
      const Vector6& truth = problem.truth((DrawnProblem::kStates - 1) * DrawnProblem::kSteps).velocity;
      estimated += (smoother.graph().states.back().velocity - truth).squaredNorm();
      smoothed += (motion.states().back().velocity - truth).squaredNorm();
    }
    CAPTURE(wrong, estimated, smoothed);
    CHECK(smoothed < remains * estimated);
  }
}

TEST_CASE("The states of the last 0.4 s are at the smoother's times, and equal its states if nothing is smoothed") {
  const Smoother smoother = solved_with(kDensity, DrawnProblem({.qc = kDensity, .pixel_sigma = 0.3}, 1));
  const auto& states = smoother.graph().states;
  for (const bool smooth : {false, true}) {
    RecentMotion motion(smooth ? std::optional<RecentPrior>(std::in_place, 0.3, 3.0, smoother.graph().qc)
                               : std::nullopt);
    motion.follow(smoother.graph(), 0);
    REQUIRE(motion.states().size() == 8);  // 0.05 s apart
    for (std::size_t i = 0; i < 8; ++i) {
      const ControlState &recent = motion.states()[i], &estimate = states[states.size() - 8 + i];
      CHECK(recent.t == estimate.t);
      CHECK((recent.T.p == estimate.T.p) == !smooth);
      CHECK((recent.T.p - estimate.T.p).norm() < 0.01);
    }
    motion.follow(smoother.graph(), static_cast<int>(states.size()) - 3);
    CHECK(motion.states().size() == 3);  // the observations before these are gone
  }
}

TEST_CASE("One state, or an estimate that is not finite, is returned unchanged") {
  FactorGraph graph;
  RecentMotion motion(RecentPrior(0.3, 3.0, graph.qc));
  graph.add_state({1.0, SE3(), Vector6::Ones()});
  motion.follow(graph, 0);
  CHECK(motion.states().size() == 1);
  graph.add_state({1.1, SE3(), Vector6::Constant(std::numeric_limits<double>::quiet_NaN())});
  motion.follow(graph, 0);
  REQUIRE(motion.states().size() == 2);
  CHECK(motion.states()[0].velocity == Vector6::Ones());
}

}  // namespace evbench::gp_map
