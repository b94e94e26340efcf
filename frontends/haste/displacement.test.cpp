#include "frontends/haste/displacement.hpp"

#include <catch2/catch.hpp>
#include <initializer_list>
#include <utility>

#include "frontends/haste/tracking/testing/event_patterns.hpp"
#include "frontends/haste/tracking/tracker.hpp"

using namespace evbench;
using namespace evbench::haste;

namespace {

std::vector<Displaced> displaced(std::initializer_list<Vector2> displacements) {
  std::vector<Displaced> result;
  for (const Vector2& displacement : displacements) {
    result.push_back({static_cast<TrackId>(result.size()), displacement, displacement});
  }
  return result;
}

using Lines = std::vector<std::pair<Vector2, Vector2>>;

std::vector<Event> events(const Lines& lines, const Vector2& place, std::uint64_t seed = 5) {
  haste::testing::EventPattern pattern;
  pattern.lines = lines;
  pattern.pose = [=](double) { return haste::testing::PatternPose{place, 0.0}; };
  pattern.noise = 0.0;
  return pattern.events(0.1, seed);
}

Template look(const Lines& lines) {
  Tracker tracker({}, {0, {120.0, 90.0}, 0.0});
  for (const Event& event : events(lines, {120.0, 90.0}, 6)) tracker.push(event);
  REQUIRE(tracker.running());
  return tracker.learnt_template();
}

}  // namespace

TEST_CASE("A look is found far from where it is expected, as far as it is looked for") {
  const Vector2 place(120.0, 90.0), there = place + Vector2(13.0, -9.0);
  const std::vector<Event> seen = events(haste::testing::corner_lines(), there);
  const Template corner = look(haste::testing::corner_lines());
  const auto found = most_like(corner, seen, place, 20, 0.45);
  REQUIRE(found);
  CHECK((*found - there).norm() < 1.5);
  CHECK_FALSE(most_like(corner, seen, place, 20, 0.999));
  CHECK_FALSE(most_like(corner, std::span(seen).first(100), place, 20, 0.45));
}

TEST_CASE("Most that are displaced by nearly the same way are told, without those that are elsewhere") {
  const auto seen = displaced({{9, 2}, {-12, 5}, {10, 1}, {8, 3}, {9, 4}, {0, -18}, {11, 2}});
  std::vector<TrackId> agreeing;
  for (const Displaced& one : agreeing_displacement(seen, 4.0)) agreeing.push_back(one.track);
  CHECK(agreeing == std::vector<TrackId>{0, 2, 3, 4, 6});
}

TEST_CASE("Few displacements that agree are chance, and so are few of many") {
  CHECK(agreeing_displacement(displaced({{9, 2}, {10, 1}, {8, 3}, {9, 4}}), 4.0).empty());
  std::vector<Displaced> seen = displaced({{9, 2}, {10, 1}, {8, 3}, {9, 4}, {11, 2}});
  CHECK(agreeing_displacement(seen, 4.0).size() == 5);
  for (int i = 0; i < 12; ++i) seen.push_back({100 + i, {}, Vector2(-20.0 + 10.0 * (i % 4), -20.0 - 10.0 * i)});
  CHECK(agreeing_displacement(seen, 4.0).empty());
  CHECK(agreeing_displacement({}, 4.0).empty());
  CHECK(agreeing_displacement(displaced({{1, 2}, {2, 1}, {0, 3}, {1, 1}, {2, 2}}), 4.0).empty());  // as expected
}
