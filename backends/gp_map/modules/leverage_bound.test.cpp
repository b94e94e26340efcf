#include "backends/gp_map/modules/leverage_bound.hpp"

#include <cmath>

#include "backends/gp_map/testing/small_scene.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {

TEST_CASE("Landmarks that are much nearer than most get larger sigmas, with the square of their nearness") {
  const std::vector<double> depths = {2.0, 2.1, 1.9, 2.0, 0.8, 0.4, 0.01};
  Counters counters;
  Estimate estimate(testing::small_scene(depths), {}, 3, 0.0, counters);
  LeverageBound({.enabled = false}).apply(estimate);
  for (int j = 0; j < 7; ++j) CHECK(estimate.leverage(j) == 1.0);
  LeverageBound({}).apply(estimate);
  const double median = estimate.median_depth();
  for (int j = 0; j < 5; ++j) CHECK(estimate.leverage(j) == 1.0);  // 0.8 is more than a third of the median
  CHECK(estimate.leverage(5) == Approx(std::pow(median / (3.0 * 0.4), 2.0)));
  CHECK(estimate.leverage(6) == 100.0);  // at most
  CHECK(estimate.graph().landmarks[6].sigma_scale == 100.0);
  CHECK(counters[Count::leverage_bounded] == 2);
  estimate.set_track_noise(6, 200.0);  // the larger one counts
  CHECK(estimate.graph().landmarks[6].sigma_scale == 200.0);
  CHECK(estimate.leverage(6) == 100.0);
}

}  // namespace evbench::gp_map
