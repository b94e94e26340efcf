#include "bench/pipeline/pace.hpp"

#include "core/testing/catch2.hpp"

namespace evbench {

TEST_CASE("The slowest pace is that of the window in which all parts together took longest") {
  const std::vector<Work> front = {{11.0, 0.1}, {12.0, 0.2}, {13.0, 0.1}, {14.0, 0.1}};
  const std::vector<Work> back = {{11.0, 0.3}, {12.5, 0.8}, {14.0, 0.4}};
  CHECK(slowest_pace({front}, 10.0, 2.0) == Approx(2.0 / 0.3));
  CHECK(slowest_pace({front, back}, 10.0, 2.0) ==
        Approx(2.0 / 1.4));  // 10 to 12.5 is longer; 11 to 13: 0.2 + 0.8 + 0.1
  CHECK(slowest_pace({front, back}, 10.0, 4.0) == Approx(4.0 / 2.0));
}

TEST_CASE("A window may be as long as all of the data, however their times are rounded") {
  CHECK(slowest_pace({{{0.1 + 0.2, 0.5}}}, 0.1, 0.2) == Approx(0.4));
  CHECK(slowest_pace({{{0.3, 0.5}}}, 0.1, 0.2) == Approx(0.4));
}

TEST_CASE("Work shorter than the window, or no work, has no slowest pace") {
  CHECK_FALSE(slowest_pace({{{11.0, 0.1}, {14.9, 0.1}}}, 10.0, 5.0));
  CHECK_FALSE(slowest_pace({}, 0.0, 5.0));
  CHECK_FALSE(slowest_pace({{}, {}}, 0.0, 5.0));
}

}  // namespace evbench

TEST_CASE("The real-time factor is data time by processing time, and none if the processing time is zero") {
  CHECK(realtime_factor(10.0, 4.0) == 2.5);
  CHECK_FALSE(realtime_factor(10.0, 0.0));
}
