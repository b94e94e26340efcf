#include "eval/quantile.hpp"

#include <cmath>
#include <limits>

#include "core/testing/catch2.hpp"

namespace evbench {

TEST_CASE("Quartiles equal those of numpy") {
  const Quartiles q = quartiles({7.0, 1.0, 3.0, 15.0});  // numpy.percentile([1, 3, 7, 15], [25, 50, 75])
  CHECK(q.lower == 2.5);
  CHECK(q.median == 5.0);
  CHECK(q.upper == 9.0);
  CHECK(quartiles({4.0}).upper == 4.0);
  const std::vector<double> sorted = {0.0, 1.0, 2.0, 3.0, 10.0};
  CHECK(quantile(sorted, 0.99) == Approx(9.72));  // numpy.percentile(..., 99)
  CHECK(quantile(sorted, 0.0) == 0.0);
  CHECK(quantile(sorted, 1.0) == 10.0);
  CHECK(quantile_of({2.0, 0.0, 1.0}, 0.75) == 1.5);
  CHECK(std::isnan(quantile({}, 0.5)));
}

TEST_CASE("Infinite values, as of failed runs, are part of quartiles") {
  const double inf = std::numeric_limits<double>::infinity();
  const Quartiles q = quartiles({1.0, inf, 2.0, 3.0});
  CHECK(q.lower == 1.75);
  CHECK(q.median == 2.5);
  CHECK(q.upper == inf);
  CHECK(quartiles({inf, inf}).lower == inf);
  CHECK(quartiles({-inf, inf}).median == 0.0);
  CHECK(quartiles({-inf, 1.0}).median == -inf);
}

}  // namespace evbench
