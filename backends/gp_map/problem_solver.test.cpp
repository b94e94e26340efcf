#include "backends/gp_map/problem_solver.hpp"

#include <catch2/catch.hpp>
#include <string>

#include "backends/gp_map/testing/oracle_distance.hpp"
#include "core/testing/data.hpp"

namespace evbench::gp_map {
namespace {

/// After the incremental steps and gp_map's final iterations, in standard deviations.
double largest_distance(const std::string& path, int every) {
  const SolveResult solved = solve_problem(read_problem(path), {});
  Engine engine(solved.graph, {});
  engine.optimise(30, 1e-9);
  return testing::distance_from_oracle(engine.graph(), every).component;
}

}  // namespace

TEST_CASE("After the final iterations the small problem's states are the oracle's within 1 % of a sigma") {
  if (const auto path = evbench::testing::problem_file("small.txt.gz")) CHECK(largest_distance(*path, 1) < 0.01);
}

TEST_CASE("After the final iterations the medium problem's states are the oracle's within 1 % of a sigma") {
  if (const auto path = evbench::testing::problem_file("medium.txt.gz")) CHECK(largest_distance(*path, 20) < 0.01);
}

}  // namespace evbench::gp_map
