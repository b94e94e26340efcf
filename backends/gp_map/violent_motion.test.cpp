#include "backends/gp_map/violent_motion.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "backends/gp_map/problem_graph.hpp"
#include "backends/gp_map/testing/drawn_problem.hpp"

namespace evbench::gp_map {
namespace {

using testing::DrawnProblem;

constexpr double kDensity = 0.01;  // [rad²/s³, m²/s³]
constexpr int kEnough = 6;         // landmarks

/// How many times as weak the prior is after a state that stands 5 ms after the last one, where so many landmarks are
/// seen so far aside of where they are expected [px], the i-th of them by i `turn` from the image's x axis on.
double yields_to(int seen, double aside, double turn) {
  Engine engine = DrawnProblem({.qc = kDensity}, 1).solve_incrementally();
  ViolentMotion motion(kEnough, 0.3);
  motion.begin(engine.graph().qc);
  const double t = engine.graph().states.back().t + 0.005;
  std::vector<int> in_view;
  for (const auto& group : engine.graph().intervals.back().groups()) in_view.push_back(group.landmark);
  REQUIRE(std::ssize(in_view) >= seen);
  add_extrapolated_state(engine, t);
  const FactorGraph& graph = engine.graph();
  for (int i = 0; i < seen; ++i) {
    const Vector3& position = graph.landmarks[index(in_view[index(i)])].position;
    const Vector2 expected = graph.camera.project(graph.states.back().T.inverse() * position);
    const Vector2 pixel = expected + aside * Vector2(std::cos(i * turn), std::sin(i * turn));
    engine.add_observation(in_view[index(i)], {t, pixel, 10.0});
  }
  motion.follow(engine, NoiseLearner(), engine.update());
  return graph.qc.maxCoeff() / kDensity;
}

}  // namespace

TEST_CASE("The prior yields to a motion that it holds back, not to tracks that err each in its own way") {
  for (const int seen : {kEnough, 12}) {
    CAPTURE(seen);
    CHECK(yields_to(seen, 2.0, 0.0) >= 10.0);
    CHECK(yields_to(seen, 1.0, 0.3) == Approx(1.0));
    CHECK(yields_to(seen, 2.0, 0.6) == Approx(1.0));
    CHECK(yields_to(seen, 0.1, 0.0) == Approx(1.0));
  }
  CHECK(yields_to(kEnough - 1, 2.0, 0.0) == Approx(1.0));
}

}  // namespace evbench::gp_map
