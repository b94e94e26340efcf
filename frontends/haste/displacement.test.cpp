#include "frontends/haste/displacement.hpp"

#include <algorithm>
#include <utility>

#include "core/geometry/se3.hpp"
#include "core/simulation/random.hpp"
#include "core/testing/catch2.hpp"
#include "frontends/haste/tracking/testing/event_patterns.hpp"
#include "frontends/haste/tracking/tracker.hpp"

using namespace evbench;
using namespace evbench::haste;

namespace {

const PinholeCamera kCamera{200.0, 200.0, 120.0, 90.0};

/// `count` landmarks near and far all over the image, seen by a camera that is off its expected pose by `motion`.
std::vector<Displaced> displaced(std::size_t count, const SE3& motion, std::uint64_t seed = 1) {
  Random random(seed);
  std::vector<Displaced> result;
  while (result.size() < count) {
    const Vector2 expected = random.uniform2({20.0, 20.0}, {220.0, 160.0});
    const Vector3 point = random.uniform(1.0, 4.0) * kCamera.ray(expected);
    const Vector2 pixel = kCamera.project(Vector3(motion.inverse() * point));
    result.push_back({static_cast<TrackId>(result.size()), pixel, pixel - expected, point});
  }
  return result;
}

/// Others, whose matches are anywhere within 20 px.
void add_chance(std::vector<Displaced>& seen, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  for (Displaced one : displaced(count, {}, seed + 1)) {
    one.track = 100 + static_cast<TrackId>(seen.size());
    one.displacement = {random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0)};
    one.pixel += one.displacement;
    seen.push_back(one);
  }
}

SE3 turned_and_moved() { return se3::exp((Vector6() << 0.02, 0.06, 0.03, -0.12, 0.05, 0.1).finished()); }

using Lines = std::vector<std::pair<Vector2, Vector2>>;

std::vector<Event> events_of(const Lines& lines, const Vector2& place, std::uint64_t seed = 5) {
  haste::testing::EventPattern pattern;
  pattern.lines = lines;
  pattern.pose = [=](double) { return haste::testing::PatternPose{place, 0.0}; };
  pattern.noise = 0.0;
  return pattern.events(0.1, seed);
}

Template look_of(const Lines& lines) {
  Tracker tracker({}, {0, {120.0, 90.0}, 0.0});
  for (const Event& event : events_of(lines, {120.0, 90.0}, 6)) tracker.push(event);
  REQUIRE(tracker.running());
  return tracker.learnt_template();
}

}  // namespace

TEST_CASE("A template is found off its expected position within the reach of the search") {
  const Vector2 place(120.0, 90.0), there = place + Vector2(13.0, -9.0);
  const std::vector<Event> seen = events_of(haste::testing::corner_lines(), there);
  const Template corner = look_of(haste::testing::corner_lines());
  const auto found = most_like(corner, seen, place, 20, 0.45);
  REQUIRE(found);
  CHECK((*found - there).norm() < 1.5);
  CHECK_FALSE(most_like(corner, seen, place, 20, 0.999));
  CHECK_FALSE(most_like(corner, std::span(seen).first(100), place, 20, 0.45));
}

TEST_CASE("Most landmarks that one camera motion displaces are returned with their displacements, without the others") {
  const std::vector<Displaced> moved = displaced(12, turned_and_moved());
  const auto length = [](const Displaced& one) { return one.displacement.norm(); };
  REQUIRE(length(std::ranges::max(moved, {}, length)) > length(std::ranges::min(moved, {}, length)) + 8.0);
  std::vector<Displaced> seen = moved;
  add_chance(seen, 4, 2);
  std::size_t right = 0, wrong = 0;
  for (const Displaced& one : displaced_together(seen, kCamera, 4.0)) ++(one.track < 100 ? right : wrong);
  CHECK(right >= 11);
  CHECK(wrong <= 1);
}

TEST_CASE("Where most landmarks are at their expected positions, a few that are not count as chance") {
  std::vector<Displaced> seen = displaced(10, {});
  add_chance(seen, 2, 4);
  CHECK(displaced_together(seen, kCamera, 4.0).empty());
}

TEST_CASE("A few landmarks displaced by one motion are chance, and so is a small share of many") {
  CHECK(displaced_together(displaced(5, turned_and_moved()), kCamera, 4.0).empty());
  std::vector<Displaced> seen = displaced(6, turned_and_moved());
  CHECK(displaced_together(seen, kCamera, 4.0).size() == 6);
  add_chance(seen, 14, 3);
  CHECK(displaced_together(seen, kCamera, 4.0).empty());
  CHECK(displaced_together({}, kCamera, 4.0).empty());
  CHECK(displaced_together(displaced(12, {}), kCamera, 4.0).empty());  // as expected
}

TEST_CASE("Random displacements are hardly ever taken for one motion") {
  int found = 0;
  constexpr int kTimes = 200;
  for (int i = 0; i < kTimes; ++i) {
    std::vector<Displaced> seen;
    add_chance(seen, 6 + static_cast<std::size_t>(i) % 15, static_cast<std::uint64_t>(i));
    if (!displaced_together(seen, kCamera, 4.0).empty()) ++found;
  }
  CHECK(found <= kTimes / 50);
}
