#include "backends/gp_map/modules/prior_relaxation.hpp"

#include <cmath>
#include <vector>

#include "backends/gp_map/observation_follower.hpp"
#include "core/smoother/testing/drawn_problem.hpp"
#include "core/support/index.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {
namespace {

using smoother::testing::DrawnProblem;

constexpr double kUnrelaxed = 0.01;  // [rad²/s³, m²/s³]
constexpr int kEnough = 6;           // landmarks

/// Relaxation of the prior after a state 5 ms after the last one. `seen` landmarks are observed with this offset from
/// their expected pixels [px], the i-th one in a direction of i `turn` from the image's x axis.
double relaxation_for(int seen, double offset, double turn) {
  Counters counters;
  Estimate estimate(DrawnProblem({.qc = kUnrelaxed}, 1).solve_incrementally().graph(), {}, kEnough, 0.0, counters);
  Smoother& smoother = estimate.smoother;
  smoother.update_everything();
  PriorRelaxation relaxation({}, 0.3, smoother.graph().qc);
  const double t = smoother.graph().states.back().t + 0.005;
  std::vector<int> in_view;
  for (const auto& group : smoother.graph().intervals.back().groups()) in_view.push_back(group.landmark);
  REQUIRE(std::ssize(in_view) >= seen);
  smoother.add_state_at(t);
  const FactorGraph& graph = smoother.graph();
  for (int i = 0; i < seen; ++i) {
    const Vector3& position = graph.landmarks[index(in_view[index(i)])].position;
    const Vector2 expected = graph.camera.project(graph.states.back().T.inverse() * position);
    const Vector2 pixel = expected + offset * Vector2(std::cos(i * turn), std::sin(i * turn));
    smoother.add_observation(in_view[index(i)], {t, pixel, 10.0});
  }
  estimate.update();
  relaxation.relax(estimate);
  CHECK(counters[Count::priors_relaxed] == (graph.qc.maxCoeff() > 1.5 * kUnrelaxed ? 1 : 0));
  return graph.qc.maxCoeff() / kUnrelaxed;
}

}  // namespace

TEST_CASE("The prior is relaxed for a motion that it suppresses, not for tracks with independent errors") {
  for (const int seen : {kEnough, 12}) {
    CAPTURE(seen);
    CHECK(relaxation_for(seen, 2.0, 0.0) >= 10.0);
    CHECK(relaxation_for(seen, 2.0, 0.6) == Approx(1.0));
    CHECK(relaxation_for(seen, 0.1, 0.0) == Approx(1.0));
  }
  CHECK(relaxation_for(kEnough - 1, 2.0, 0.0) == Approx(1.0));
}

}  // namespace evbench::gp_map
