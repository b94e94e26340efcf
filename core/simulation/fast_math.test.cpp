#include "core/simulation/fast_math.hpp"

#include <cmath>

#include "core/testing/catch2.hpp"

using namespace evbench;

TEST_CASE("Fast logarithm and exponential are as exact as they say") {
  double log_error = 0.0, exp_error = 0.0;
  for (float x = 1e-30F; x < 1e30F; x *= 1.0037F) {
    const double exact = std::log(static_cast<double>(x));
    log_error = std::max(log_error, std::abs(fast_log(x) - exact) / std::max(1.0, std::abs(exact)));
  }
  for (float x = -80.0F; x < 80.0F; x += 0.0113F) {
    exp_error = std::max(exp_error, std::abs(fast_exp(x) / std::exp(static_cast<double>(x)) - 1.0));
  }
  CHECK(log_error < 2e-7);
  CHECK(exp_error < 3e-7);
  CHECK(fast_log(1.0F) == 0.0F);
  CHECK(fast_exp(0.0F) == 1.0F);
}
