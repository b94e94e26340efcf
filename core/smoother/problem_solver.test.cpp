#include "core/smoother/problem_solver.hpp"

#include <string>

#include "core/simulation/random.hpp"
#include "core/smoother/testing/oracle_distance.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

namespace evbench::smoother {
namespace {

/// Largest distance from the oracle, after the incremental steps and gp_map's final iterations, in standard deviations.
double largest_distance(const std::string& path, int every) {
  const SolveResult solved = solve_problem(read_problem(path), {});
  Smoother engine(solved.graph, {});
  engine.optimise(30, 1e-9);
  return testing::distance_from_oracle(engine.graph(), every).component;
}

/// The problem with so many copies of each landmark; each copy but the first has additional noise of its own.
Problem multiplied(const Problem& problem, int times) {
  Problem result = problem;
  Random random(1);
  const int landmarks = static_cast<int>(problem.landmarks.size());
  result.observations.clear();
  for (const Problem::Observation& z : problem.observations) {
    for (int i = 0; i < times; ++i) {
      result.observations.push_back(z);
      result.observations.back().landmark += i * landmarks;
      if (i > 0) result.observations.back().pixel += z.noise.sigma() * random.normal2();
    }
  }
  for (int i = 1; i < times; ++i) {
    result.landmarks.insert(result.landmarks.end(), problem.landmarks.begin(), problem.landmarks.end());
    for (auto prior : problem.landmark_priors) {
      prior.landmark += i * landmarks;
      result.landmark_priors.push_back(prior);
    }
  }
  return result;
}

}  // namespace

TEST_CASE("An incremental estimate is near the optimum, with 40 live landmarks and with 200", "[slow]") {
  const auto path = evbench::testing::problem_file("small.txt.gz");
  if (!path) return;
  const Problem problem = read_problem(*path);
  for (const int times : {1, 5}) {
    const SolveResult solved = solve_problem(multiplied(problem, times), {});
    CHECK(check_against_batch(solved.graph).relative_excess < 1e-4);
  }
}

TEST_CASE("After the final iterations the small problem's states equal the oracle's within 1 % of a sigma", "[slow]") {
  if (const auto path = evbench::testing::problem_file("small.txt.gz")) CHECK(largest_distance(*path, 1) < 0.01);
}

TEST_CASE("After the final iterations the medium problem's states equal the oracle's within 1 % of a sigma", "[long]") {
  if (const auto path = evbench::testing::problem_file("medium.txt.gz")) CHECK(largest_distance(*path, 20) < 0.01);
}

}  // namespace evbench::smoother
