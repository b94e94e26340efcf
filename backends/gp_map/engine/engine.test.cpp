#include "backends/gp_map/engine/engine.hpp"

#include <catch2/catch.hpp>

#include "backends/gp_map/batch_solver.hpp"
#include "backends/gp_map/problem_graph.hpp"
#include "core/testing/data.hpp"

namespace evbench::gp_map {

TEST_CASE("Optimising with the engine ends where the batch solver ends") {
  const auto path = testing::problem_file("small.txt.gz");
  if (!path) return;
  FactorGraph oracle = to_graph(read_problem(*path));
  Engine engine(oracle, {});
  const auto summary = engine.optimise(10, 1e-12);
  const auto expected = solve_batch(oracle, {20, 1e-12, 0});
  CHECK(summary.converged);
  CHECK(summary.final_cost == Approx(expected.final_cost).epsilon(1e-9));
  for (std::size_t i = 0; i < oracle.states.size(); ++i) {
    const Vector6 apart = se3::log(oracle.states[i].T.inverse() * engine.graph().states[i].T);
    CHECK(apart.norm() < 1e-6);
  }
}

}  // namespace evbench::gp_map
