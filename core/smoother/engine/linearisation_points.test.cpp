#include "core/smoother/engine/linearisation_points.hpp"

#include "core/geometry/so3.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::smoother {

TEST_CASE("An increment that is taken back leaves the state to the bit") {
  constexpr int kSize = 12;
  for (int i = 0; i < 100; ++i) {
    FactorGraph graph;
    const Vector3 turn(0.1 * i, 1.0 - 0.03 * i, 0.2);
    graph.states.push_back({0.0, {so3::exp(turn), Vector3(1e9, 0.1 * i, 1e-9)}, Vector6::Constant(0.3 * i)});
    const ControlState before = graph.states.front();
    LinearisationPoints points(4, kSize);
    points.add_state(before);
    points.set_state_delta(graph, 0, StateVector::Constant(kSize, 0.4));
    CHECK(graph.states.front().T.p != before.T.p);
    points.set_state_delta(graph, 0, StateVector::Zero(kSize));
    CHECK(graph.states.front().T.q.coeffs() == before.T.q.coeffs());
    CHECK(graph.states.front().T.p == before.T.p);
    CHECK(graph.states.front().velocity == before.velocity);
  }
}

}  // namespace evbench::smoother
