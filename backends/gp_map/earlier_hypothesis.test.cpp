#include "backends/gp_map/earlier_hypothesis.hpp"

#include <cstdint>
#include <utility>

#include "backends/gp_map/testing/ambiguous_sequence.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {
namespace {

using namespace ambiguous_sequence;

constexpr int kLong = 2 * kStates;

/// A wrong estimate until the turn, followed by the true motion.
FactorGraph misled_at_first(const FactorGraph& truth) {
  FactorGraph beginning = truth;
  while (beginning.states.size() > kStates) beginning.remove_newest_state();
  beginning = misled(std::move(beginning));
  FactorGraph graph = truth;
  const SE3 along = beginning.states.back().T * truth.states[kStates - 1].T.inverse();
  for (std::size_t k = 0; k < graph.states.size(); ++k) {
    ControlState& state = graph.states[k];
    state = k < kStates ? beginning.states[k] : ControlState{state.t, along * state.T, state.velocity};
  }
  for (std::size_t j = 0; j < graph.landmarks.size(); ++j) {
    Vector3& position = graph.landmarks[j].position;
    const bool early = !beginning.landmarks[j].intervals.empty();
    position = early ? beginning.landmarks[j].position : Vector3(along * position);
  }
  Engine engine(std::move(graph), {});
  engine.optimise(50, 1e-9);
  return engine.graph();
}

}  // namespace

TEST_CASE("A wrong estimate of the past is replaced by the true one with the data after it", "[slow]") {
  int found = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    const FactorGraph truth = solved(simulate_problem({0.0, 0.3}, seed, false, kLong)), wrong = misled_at_first(truth);
    const auto error = [&truth](const FactorGraph& graph) {
      return (graph.states.back().T.p - truth.states.back().T.p).norm();
    };
    REQUIRE(cost(wrong) > cost(truth) + 100.0);
    REQUIRE(error(wrong) > 0.3);
    const auto other = try_earlier_hypotheses(Engine(wrong, {}), kEnough);
    if (!other) continue;
    CHECK(cost(other->graph()) < cost(wrong) - 10.0);
    if (error(other->graph()) < 0.01) ++found;
    CHECK_FALSE(try_earlier_hypotheses(Engine(truth, {}), kEnough));
  }
  CHECK(found >= 2);  // of 6: attempts are 0.6 s apart, and miss some
}

}  // namespace evbench::gp_map
