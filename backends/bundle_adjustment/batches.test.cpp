#include "backends/bundle_adjustment/batches.hpp"

#include <algorithm>
#include <cmath>

#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::bundle_adjustment;

namespace {

UndistortedObservation observation(TrackId id, double t, double x, double sigma = 1.0) {
  return {id, t, {x, 2.0 * x}, sigma};
}

}  // namespace

TEST_CASE("a feature in a batch is the mean of its observations, at their mean time") {
  BatchBuilder builder({0.1});
  CHECK(builder.add(std::vector{observation(2, 0.00, 10), observation(1, 0.02, 50), observation(2, 0.06, 14)}).empty());
  const std::vector<Batch> batches = builder.advance(0.1);
  REQUIRE(batches.size() == 1);
  CHECK(batches[0].t == Approx(0.08 / 3));
  CHECK(batches[0].end == Approx(0.1));  // known only then
  REQUIRE(batches[0].keypoints.size() == 2);
  CHECK(batches[0].keypoints[0].track == 1);
  CHECK(batches[0].keypoints[0].noise.sigma() == Approx(1.0));
  CHECK(batches[0].keypoints[1].pixel.isApprox(Vector2(12, 24)));
  CHECK(batches[0].keypoints[1].noise.sigma() == Approx(std::sqrt(0.5)));
}

TEST_CASE("noise that a track's observations share stays in their mean") {
  BatchBuilder builder({.duration = 0.1, .common_noise_px = 0.6});
  std::vector<UndistortedObservation> observations;
  for (int i = 0; i < 50; ++i) observations.push_back(observation(1, 0.001 * i, 10));
  builder.add(observations);
  CHECK(builder.advance(0.1).at(0).keypoints.at(0).noise.sigma() == Approx(std::sqrt(0.36 + 0.64 / 50)));
}

TEST_CASE("batches by duration follow one another, and a gap makes none") {
  BatchBuilder builder({0.1});
  std::vector<Batch> batches = builder.add(std::vector{observation(1, 1.0, 1), observation(1, 1.05, 1),
                                                       observation(1, 1.12, 2), observation(1, 1e6 + 0.05, 3)});
  REQUIRE(batches.size() == 2);
  CHECK(batches[0].t == Approx(1.025));
  CHECK(batches[1].t == Approx(1.12));
  batches = builder.advance(1e6 + 1.0);
  REQUIRE(batches.size() == 1);
  CHECK(batches[0].t == Approx(1e6 + 0.05));
  CHECK(builder.advance(2e6).empty());
}

TEST_CASE("batches by count have that many observations") {
  BatchBuilder builder({0.1, 3});
  std::vector<UndistortedObservation> observations;
  for (int i = 0; i < 8; ++i) observations.push_back(observation(1, 0.5 * i, i));
  const std::vector<Batch> batches = builder.add(observations);
  REQUIRE(batches.size() == 2);
  CHECK(batches[0].keypoints.at(0).pixel.x() == Approx(1.0));
  CHECK(batches[1].keypoints.at(0).pixel.x() == Approx(4.0));
  CHECK(builder.advance(100.0).empty());
  const std::optional<Batch> rest = builder.rest();
  REQUIRE(rest);
  CHECK(rest->keypoints.at(0).pixel.x() == Approx(6.5));
}

TEST_CASE("batches by motion end when the median track has moved so far, within bounds of time") {
  BatchBuilder builder({.duration = 0.5, .motion_px = 5.0, .shortest_duration = 0.02});
  std::vector<UndistortedObservation> observations;
  // Three tracks at 40, 100 and 0 px/s for a second, then ten times as fast, then at rest.
  for (int i = 0; i <= 200; ++i) {
    const double t = 0.01 * i, fast = std::clamp(t - 1.0, 0.0, 0.2);
    const double moved = std::min(t, 1.0) + 10.0 * fast;
    for (const double speed : {40.0, 100.0, 0.0}) {
      observations.push_back({static_cast<TrackId>(speed), t, {speed * moved, 0.0}, 1.0});
    }
  }
  std::vector<Batch> batches = builder.add(observations);
  const auto longest = [&](double from, double to) {
    double length = 0.0;
    for (std::size_t i = 1; i < batches.size(); ++i) {
      if (batches[i - 1].end >= from && batches[i].end <= to)
        length = std::max(length, batches[i].end - batches[i - 1].end);
    }
    return length;
  };
  CHECK(longest(0.0, 1.0) == Approx(0.14).margin(0.011));  // 5 px at 40 px/s, the next observation after it
  CHECK(longest(1.02, 1.19) == Approx(0.03).margin(0.011));
  CHECK(longest(1.2, 2.0) == Approx(0.5));  // at rest
  BatchBuilder bounded({.duration = 0.5, .motion_px = 5.0, .shortest_duration = 0.2});
  batches = bounded.add(observations);
  CHECK(longest(0.0, 1.0) == Approx(0.2).margin(0.011));
}

TEST_CASE("no observations make no batches") {
  BatchBuilder builder({0.1});
  CHECK(builder.add({}).empty());
  CHECK(builder.advance(10.0).empty());
  CHECK_FALSE(builder.rest());
}
