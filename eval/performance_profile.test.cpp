#include "eval/performance_profile.hpp"

#include <limits>

#include "core/testing/catch2.hpp"

namespace evbench {

TEST_CASE("A performance profile is the share of problems solved within a factor of the best") {
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<std::vector<double>> costs = {{1.0, 4.0, inf, inf}, {2.0, 2.0, 3.0, inf}};
  const auto profiles = performance_profiles(costs);
  REQUIRE(profiles.size() == 2);
  CHECK(profiles[0].ratios == std::vector{1.0, 2.0});
  CHECK(profiles[1].ratios == std::vector{1.0, 1.0, 2.0});
  CHECK(profiles[0].at(1.0) == 0.25);
  CHECK(profiles[0].at(1.99) == 0.25);
  CHECK(profiles[0].at(2.0) == 0.5);
  CHECK(profiles[1].at(1.0) == 0.5);
  CHECK(profiles[1].at(100.0) == 0.75);  // a problem without a solution counts for no method
  CHECK(profiles[0].at(0.5) == 0.0);
}

TEST_CASE("A cost of zero is the best, and infinitely better than any other") {
  const auto profiles = performance_profiles(std::vector<std::vector<double>>{{0.0, 0.0}, {0.0, 1.0}});
  CHECK(profiles[0].at(1.0) == 1.0);
  CHECK(profiles[1].at(1e9) == 0.5);
}

}  // namespace evbench
