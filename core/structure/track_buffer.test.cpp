#include "core/structure/track_buffer.hpp"

#include <cmath>
#include <limits>

#include "core/testing/catch2.hpp"
#include "core/testing/point_scene.hpp"

using namespace evbench;

namespace {

UndistortedObservation observation(TrackId id, double t, double x, double y) { return {id, t, {x, y}, 1.0}; }

}  // namespace

TEST_CASE("a track's observations are in time order, in whatever order they are added") {
  TrackBuffer buffer;
  buffer.add(std::vector{observation(7, 0.2, 2, 0), observation(3, 0.1, 1, 1), observation(7, 0.1, 1, 0)});
  const auto track = buffer.observations(7);
  REQUIRE(track.size() == 2);
  CHECK(track[0].t == 0.1);
  CHECK(track[1].t == 0.2);
  CHECK(buffer.ids() == std::vector<TrackId>{3, 7});
  CHECK(buffer.observations(8).empty());
  CHECK(buffer.alive(0.15) == std::vector<TrackId>{7});
  CHECK(buffer.alive(0.15, 0.06) == std::vector<TrackId>{3, 7});
}

TEST_CASE("a forgotten track accepts new observations, a removed one does not") {
  TrackBuffer buffer;
  buffer.add(std::vector{observation(1, 0.1, 1, 0), observation(2, 0.5, 2, 0), observation(3, 0.9, 3, 0)});
  buffer.forget_ended_before(0.5);
  CHECK(buffer.ids() == std::vector<TrackId>{2, 3});
  buffer.forget(2);
  buffer.remove(3);
  CHECK(buffer.empty());
  buffer.add(std::vector{observation(2, 1.0, 2, 0), observation(3, 1.0, 3, 0)});
  CHECK(buffer.ids() == std::vector<TrackId>{2});
  CHECK(buffer.observations(2).size() == 1);
}

TEST_CASE("observations that are not finite never enter the buffer") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  TrackBuffer buffer;
  buffer.add(std::vector{observation(1, nan, 2, 0), observation(1, 0.1, nan, 0), observation(1, 0.1, 0, INFINITY)});
  CHECK(buffer.empty());
}

TEST_CASE("a removed track has no observations and accepts none") {
  TrackBuffer buffer;
  buffer.add(std::vector{observation(1, 0.1, 2, 0), observation(2, 0.1, 2, 0)});
  buffer.remove(1);
  buffer.add(std::vector{observation(1, 0.2, 2, 0)});
  CHECK(buffer.removed(1));
  CHECK(buffer.ids() == std::vector<TrackId>{2});
}

TEST_CASE("a track's position at a time is the line through its observations there") {
  TrackBuffer buffer;
  std::vector<UndistortedObservation> observations;
  for (int i = 0; i < 40; ++i) {
    const double t = 0.01 * i;
    observations.push_back(observation(1, t, std::round(10.0 + 43.0 * t), std::round(80.0 - 21.0 * t)));
  }
  observations[20].pixel += Vector2(30.0, -20.0);  // the tracker jumps for one update
  buffer.add(observations);

  const auto place = buffer.position(1, 0.205, 0.1);
  REQUIRE(place);
  CHECK((*place - Vector2(10.0 + 43.0 * 0.205, 80.0 - 21.0 * 0.205)).norm() < 0.6);

  CHECK_FALSE(buffer.position(1, 0.6, 0.1));
  CHECK_FALSE(buffer.position(1, -0.04, 0.1));
  CHECK_FALSE(buffer.position(2, 0.2, 0.1));
  CHECK(buffer.position(1, 0.39, 0.1));
}

TEST_CASE("a single observation gives the position at its own time only") {
  TrackBuffer buffer;
  buffer.add(std::vector{observation(1, 0.5, 10, 20)});
  REQUIRE(buffer.position(1, 0.5, 0.05));
  CHECK(buffer.position(1, 0.5, 0.05)->isApprox(Vector2(10, 20)));
  CHECK_FALSE(buffer.position(1, 0.51, 0.05));
}

TEST_CASE("a slow tracker's position at a time is the line through its nearest observations") {
  TrackBuffer buffer;
  std::vector<UndistortedObservation> observations;
  const auto at = [](double t) { return Vector2(10.0 + 4.0 * t, 20.0 - 3.0 * t); };
  for (int i = 0; i < 10; ++i) observations.push_back(observation(1, 0.2 * i, at(0.2 * i).x(), at(0.2 * i).y()));
  for (const double t : {2.7, 2.9, 3.1}) observations.push_back(observation(1, t, 30, 30));  // after an unusual gap
  buffer.add(observations);
  for (const double t : {0.5, 0.61, 1.7, 1.81, 1.95}) {
    INFO(t);
    const auto place = buffer.position(1, t, {0.1, true});
    CHECK_FALSE(buffer.position(1, t, 0.1));
    REQUIRE(place);
    CHECK((*place - at(t)).norm() < 1e-9);
  }
  CHECK(buffer.position(1, -0.15, {0.1, true}));        // less than one observation interval before its beginning
  CHECK_FALSE(buffer.position(1, -0.25, {0.1, true}));  // more than one
  CHECK_FALSE(buffer.position(1, 2.26, {0.1, true}));
  CHECK_FALSE(buffer.position(1, 3.4, {0.1, true}));
}
