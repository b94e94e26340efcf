#include "eval/statistics.hpp"

#include <cmath>
#include <vector>

#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

namespace evbench {

TEST_CASE("Statistics of a few numbers equal those computed by hand") {
  const Statistics s = statistics(std::vector<double>{4.0, 1.0, 3.0, 2.0});
  CHECK(s.rmse == Approx(std::sqrt(7.5)));
  CHECK(s.mean == Approx(2.5));
  CHECK(s.median == Approx(2.5));
  CHECK(s.std == Approx(std::sqrt(1.25)));
  CHECK(s.min == 1.0);
  CHECK(s.max == 4.0);
  CHECK(s.sse == Approx(30.0));
  CHECK(s.n == 4);
  CHECK(statistics(std::vector<double>{5.0, 1.0, 3.0}).median == 3.0);
}

TEST_CASE("Statistics of an empty set are null in JSON") {
  const Json json = to_json(statistics({}));
  CHECK(json.at("n") == 0);
  CHECK(json.at("sse") == 0.0);
  for (const char* key : {"rmse", "mean", "median", "std", "min", "max"}) CHECK(json.at(key).is_null());
}

}  // namespace evbench
