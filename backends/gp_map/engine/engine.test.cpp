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

TEST_CASE("Covariances of the engine are those of the batch solver") {
  const auto path = testing::problem_file("small.txt.gz");
  if (!path) return;
  Engine engine(to_graph(read_problem(*path)), {});
  engine.optimise(10, 1e-12);
  const BatchCovariance oracle(engine.graph());
  const int newest = static_cast<int>(engine.graph().states.size()) - 1;
  for (const int k : {0, 1, 50, newest - 2, newest - 1}) {
    const auto joint = engine.neighbours(k);
    const auto expected = oracle.neighbours(k);
    REQUIRE(joint);
    REQUIRE(expected);
    CHECK((*joint - *expected).norm() < 1e-6 * expected->norm());
  }
  for (const double t : {0.01, 2.513, engine.graph().states.back().t}) {
    CHECK((*engine.covariance(t) - *oracle.at(t)).norm() < 1e-6 * oracle.at(t)->norm());
  }
  const int landmarks = static_cast<int>(engine.graph().landmarks.size());
  for (const int j : {0, landmarks / 2, landmarks - 1}) {
    if (!engine.graph().landmarks[static_cast<std::size_t>(j)].alive) continue;
    CHECK((*engine.landmark_covariance(j) - *oracle.landmark(j)).norm() < 1e-6 * oracle.landmark(j)->norm());
  }
}

}  // namespace evbench::gp_map
