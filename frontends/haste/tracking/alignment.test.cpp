#include "frontends/haste/tracking/alignment.hpp"

#include <utility>

#include "core/testing/catch2.hpp"
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

TEST_CASE("A template matches best at its pattern's position and angle") {
  const Template wanted = seen_at({60, 50});
  const double turn = 3 * kAngleStep;
  const std::vector<Event> events = still({104, 83}, turn).events(0.02, 2);
  const auto found = [&](const Template& t, int angle) {
    Alignment best;
    for (int y = -8; y <= 8; ++y) {
      for (int x = -8; x <= 8; ++x) {
        const Alignment seen = align(t, events, {100 + x, 80 + y, angle});
        if (seen.score > best.score) best = seen;
      }
    }
    return best;
  };
  const Alignment turned = found(wanted, 3), warped = found(wanted.warped(turn, 1.0), 0);
  CHECK(std::hypot(turned.x - 104, turned.y - 83) < 1.5);
  CHECK(std::hypot(warped.x - 104, warped.y - 83) < 1.5);
  CHECK(turned.score > 0.8);
  CHECK(warped.score > 0.8);
  CHECK(turned.event_count == kWindowSize);
  CHECK(align(wanted, events, {98, 77, 3}).score < 0.6);
}

TEST_CASE("Many positions at once give the same as one by one, also without a full window and at the border") {
  const Template wanted = seen_at({60, 50});
  const std::vector<Event> events = still({15, 83}, 0.0).events(0.02, 2);
  for (const auto& [radius, step] : {std::pair(8, 1), std::pair(20, 2), std::pair(7, 3), std::pair(0, 1)}) {
    const auto all = align_around(wanted, events, {9, 80}, radius, step);
    std::size_t i = 0;
    for (int y = 80 - radius; y <= 80 + radius; y += step) {
      for (int x = 9 - radius; x <= 9 + radius; x += step, ++i) {
        REQUIRE(i < all.size());
        const Alignment alone = align(wanted, events, {x, y, 0});
        CHECK((all[i].x == x && all[i].y == y && all[i].event_count == alone.event_count));
        CHECK(all[i].score == Approx(alone.score).margin(1e-12));
      }
    }
    CHECK(i == all.size());
  }
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
