#include "eval/bootstrap.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/testing/catch2.hpp"

namespace evbench {

TEST_CASE("A bootstrap interval is reproducible, contains the median, and narrows with more values") {
  std::mt19937_64 random(3);
  std::vector<double> values;
  for (int i = 0; i < 400; ++i) values.push_back(static_cast<double>(random() % 1000));
  const std::span<const double> all(values);
  const Interval few = bootstrap_median(all.first(20)), many = bootstrap_median(all);
  const Interval again = bootstrap_median(all.first(20));
  CHECK(few.from == again.from);
  CHECK(few.to == again.to);
  CHECK(many.from < 500.0);
  CHECK(many.to > 500.0);
  CHECK(many.to - many.from < 0.5 * (few.to - few.from));
}

TEST_CASE("A bootstrap interval of the median contains it as often as its level states") {
  std::mt19937_64 random(7);
  int right = 0;
  for (int i = 0; i < 200; ++i) {
    std::vector<double> values;
    for (int k = 0; k < 25; ++k) values.push_back(static_cast<double>(random() % 1001));  // of median 500
    const Interval interval = bootstrap_median(values, {.level = 0.9, .samples = 500});
    right += interval.from <= 500.0 && 500.0 <= interval.to ? 1 : 0;
  }
  CHECK(right >= 170);
  CHECK(right <= 192);
}

TEST_CASE("One value has an infinite interval, and failures extend an interval") {
  const double inf = std::numeric_limits<double>::infinity();
  CHECK(bootstrap_median(std::vector<double>{1.0}).to == inf);
  CHECK(bootstrap_median(std::vector<double>{1.0}).from == -inf);
  const Interval interval = bootstrap_median(std::vector<double>{1.0, 2.0, 3.0, 4.0, inf, inf});
  CHECK(interval.from >= 1.0);
  CHECK(interval.to == inf);
}

}  // namespace evbench
