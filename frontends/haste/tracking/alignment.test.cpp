#include "frontends/haste/tracking/alignment.hpp"

#include <catch2/catch.hpp>

#include "frontends/haste/tracking/testing/event_patterns.hpp"
#include "frontends/haste/tracking/tracker.hpp"

using namespace evbench;
using namespace evbench::haste;
using namespace evbench::haste::testing;

namespace {

EventPattern still(const Vector2& position, double angle) {
  EventPattern pattern;
  pattern.lines = corner_lines();
  pattern.pose = [=](double) { return PatternPose{position, angle}; };
  return pattern;
}

Template seen_at(const Vector2& position) {
  Tracker tracker({}, {0, position, 0.0});
  for (const Event& event : still(position, 0.0).events(0.02, 1)) tracker.push(event);
  return tracker.learnt_template();
}

}  // namespace

TEST_CASE("A template is found where its pattern is, among all places around, turned as it is") {
  const Template wanted = seen_at({60, 50});
  const double turn = 3 * kAngleStep;
  const std::vector<Event> events = still({104, 83}, turn).events(0.02, 2);
  const auto found = [&](const Template& t, int angle) {
    const auto all = align_around(t, events, {100, 80, angle}, 8);
    REQUIRE(all.size() == 17 * 17);
    return *std::ranges::max_element(all, {}, [](const Alignment& a) { return a.score; });
  };
  const Alignment turned = found(wanted, 3), warped = found(wanted.warped(turn, 1.0), 0);
  CHECK(std::hypot(turned.x - 104, turned.y - 83) < 1.5);
  CHECK(std::hypot(warped.x - 104, warped.y - 83) < 1.5);
  CHECK(turned.score > 0.8);
  CHECK(warped.score > 0.8);
  CHECK(turned.event_count == kWindowSize);
  CHECK(align(wanted, events, {98, 77, 3}).score < 0.6);
}

TEST_CASE("Only the newest full window counts, and nothing aligns with nothing") {
  const Template wanted = seen_at({60, 50});
  std::vector<Event> events(500, {0, 62, 40, true});
  const std::vector<Event> newest = still({60, 50}, 0.0).events(0.02, 3);
  const double alone = align(wanted, newest, {60, 50, 0}).score;
  events.insert(events.end(), newest.begin(), newest.end());
  CHECK(align(wanted, events, {60, 50, 0}).score == alone);
  CHECK(align(wanted, {}, {60, 50, 0}).score == 0.0);
  CHECK(align(wanted, {}, {60, 50, 0}).event_count == 0);
  CHECK(align(Template{}, newest, {60, 50, 0}).score == 0.0);
}
