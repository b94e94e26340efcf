#include "frontends/haste/tracking/tracker.hpp"

#include <limits>

#include "core/testing/catch2.hpp"
#include "frontends/haste/tracking/testing/event_patterns.hpp"
#include "frontends/haste/tracking/testing/plain_tracker.hpp"

using namespace evbench;
using namespace evbench::haste;
using namespace evbench::haste::testing;

namespace {

constexpr std::array kVariants = {Variant::correlation, Variant::haste_correlation, Variant::haste_correlation_star,
                                  Variant::haste_difference, Variant::haste_difference_star};

TrackerOptions options_of(Variant variant) {
  TrackerOptions options;
  options.variant = variant;
  return options;
}

EventPattern moving(const std::function<PatternPose(double)>& pose) {
  EventPattern pattern;
  pattern.lines = corner_lines();
  pattern.pose = pose;
  return pattern;
}

/// Pushes all events to both trackers and compares everything after each. Returns how often the state has changed.
int compare(const TrackerOptions& options, const GridState& seed, const std::vector<Event>& events) {
  Tracker tracker(options, {0, Vector2(seed.x, seed.y), kAngleStep * seed.angle});
  PlainTracker plain(options, seed);
  int changes = 0;
  for (const Event& event : events) {
    const Tracker::Update update = tracker.push(event);
    const bool same = update == plain.push(event) && tracker.grid_state() == plain.grid_state() &&
                      tracker.state().t == plain.t() && tracker.scores().of == plain.scores().of;
    if (!same) FAIL("not the same at t = " << event.t);
    changes += update == Tracker::Update::changed;
  }
  return changes;
}

/// The largest distance of the tracker from the pattern's middle at its changes, and the final angle.
struct Followed {
  double error = 0.0;
  double angle = 0.0;
  int changes = 0;
};
Followed follow(const TrackerOptions& options, const EventPattern& pattern, double duration) {
  const PatternPose start = pattern.pose(0.0);
  Tracker tracker(options, {0, start.position, start.angle});
  Followed result;
  for (const Event& event : pattern.events(duration, 1)) {
    if (tracker.push(event) != Tracker::Update::changed) continue;
    const PatternPose truth = pattern.pose(1e-6 * static_cast<double>(tracker.state().t));
    result.error = std::max(result.error, (midpoint(tracker.change()) - truth.position).norm());
    ++result.changes;
  }
  result.angle = tracker.state().angle;
  return result;
}

}  // namespace

TEST_CASE("Every variant equals the plain transcription bit by bit, whatever the motion", "[slow]") {
  for (const Variant variant : kVariants) {
    int changes = 0;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      const double speed = seed % 2 == 0 ? 60.0 : 600.0, turn = seed < 2 ? 0.3 : -4.0;
      EventPattern pattern = moving([=](double t) {
        return PatternPose{{120 + 30 * std::sin(speed / 30 * t), 90 + 20 * std::sin(speed / 23 * t)}, turn * t};
      });
      pattern.noise = seed == 3 ? 0.3 : 0.05;
      const bool slow = variant == Variant::correlation || variant == Variant::haste_difference;
      changes += compare(options_of(variant), {120, 90, 0}, pattern.events(slow ? 0.05 : 0.5, seed));
    }
    CHECK(changes > 20);
  }
}

TEST_CASE("Every variant follows a corner that moves, to within a pixel") {
  for (const Variant variant : kVariants) {
    const Followed followed = follow(options_of(variant), moving([](double t) {
                                       return PatternPose{{80 + 50 * t, 60 + 30 * t}, 0.0};
                                     }),
                                     0.4);
    CHECK(followed.error < 1.2);
    CHECK(followed.changes > 20);
    CHECK(std::abs(followed.angle) < 2.5 * kAngleStep);
  }
}

TEST_CASE("Every variant turns with a corner that turns") {
  for (const Variant variant : kVariants) {
    const double rate = 2.0, duration = 0.4;
    const Followed followed = follow(options_of(variant), moving([=](double t) {
                                       return PatternPose{{80, 60}, rate * t};
                                     }),
                                     duration);
    CHECK(followed.angle == Approx(rate * duration).margin(2 * kAngleStep));
    CHECK(followed.error < 1.6);
  }
}

TEST_CASE("A tracker starts with its window's last event, at the middle one's time") {
  Tracker tracker({}, {0, {50.25, 40.5}, 0.1});
  for (int i = 0; i < kWindowSize; ++i) {
    CHECK(!tracker.running());
    CHECK(tracker.scores().of == Scores{}.of);
    const auto update = tracker.push({1000 + i, static_cast<std::uint16_t>(45 + i % 10), 40, true});
    CHECK(update == (i + 1 < kWindowSize ? Tracker::Update::collecting : Tracker::Update::started));
  }
  CHECK(tracker.change().after.t == 1000 + kWindowSize / 2);
  CHECK(tracker.change().t_event == 1000 + kWindowSize - 1);
  CHECK(tracker.change().before.position == Vector2(50.25, 40.5));
  CHECK(tracker.change().after.position == Vector2(50.25, 40.5));
  CHECK(tracker.state().angle == Approx(0.1));
  CHECK(tracker.learnt_template().mass() == kWindowSize);
  CHECK(tracker.event_count() == kWindowSize);
}

TEST_CASE("An event 15 px away is out of range, one nearer is not") {
  Tracker tracker({}, {0, {50, 40}, 0.0});
  CHECK(tracker.push({0, 65, 40, true}) == Tracker::Update::out_of_range);
  CHECK(tracker.push({0, 50, 55, true}) == Tracker::Update::out_of_range);
  CHECK(tracker.push({0, 59, 52, true}) == Tracker::Update::out_of_range);  // 9² + 12² = 15²
  CHECK(tracker.push({0, 64, 40, true}) == Tracker::Update::collecting);
  CHECK(tracker.push({0, 58, 52, true}) == Tracker::Update::collecting);
  CHECK(tracker.event_count() == 2);
}

TEST_CASE("At the image's border and beyond every variant equals the plain transcription and goes on", "[slow]") {
  for (const Variant variant : kVariants) {
    EventPattern pattern = moving([](double t) { return PatternPose{{12 - 60 * t, 8 - 20 * t}, 0.0}; });
    compare(options_of(variant), {12, 8, 0}, pattern.events(0.25, 5));
  }
}

TEST_CASE("Equal times, events one on another, and a burst at one pixel do no harm", "[slow]") {
  EventPattern pattern = moving([](double t) { return PatternPose{{60 + 100 * t, 60}, t}; });
  std::vector<Event> events;
  for (const Event& event : pattern.events(0.03, 7)) {
    events.push_back(event);
    events.push_back(event);
    events.back().t = events.front().t;
  }
  for (int i = 0; i < 3 * kWindowSize; ++i) events.push_back({events.back().t, 61, 62, true});
  for (const Event& event : pattern.events(0.03, 8)) events.push_back(event);
  for (const Variant variant : kVariants) {
    compare(options_of(variant), {60, 60, 0}, events);
    compare(options_of(variant), {61, 62, 17}, std::vector<Event>(2 * kWindowSize, {5, 61, 62, false}));
    Tracker tracker(options_of(variant), {0, {60, 60}, 0.0});
    for (const Event& event : events) {
      tracker.push(event);
      for (const double score : tracker.scores().of) REQUIRE(std::isfinite(score));
      REQUIRE(std::isfinite(tracker.scores().spread()));
      REQUIRE(tracker.state().position.allFinite());
    }
  }
}

TEST_CASE("A tracker with a stored template stays on its point where it is re-acquired") {
  const EventPattern pattern = moving([](double t) { return PatternPose{{80 + 50 * t, 60}, 0.0}; });
  Tracker first({}, {0, {80, 60}, 0.0});
  for (const Event& event : pattern.events(0.2, 1)) first.push(event);
  const EventPattern again = moving([](double t) { return PatternPose{{150 - 40 * t, 100 + 20 * t}, 0.0}; });
  Tracker second({}, {0, {150, 100}, 0.0}, first.learnt_template());
  CHECK(second.learnt_template().cells() == first.learnt_template().cells());
  for (const Event& event : again.events(0.5, 2)) second.push(event);
  CHECK((second.state().position - Vector2(130, 110)).norm() < 1.5);
}

TEST_CASE("A template that is empty keeps the state and gives finite scores") {
  for (const Variant variant : kVariants) {
    TrackerOptions options = options_of(variant);
    options.template_learning = 0.0;
    Tracker tracker(options, {0, {80, 60}, 0.0}, Template{});
    for (const Event& event : moving([](double) { return PatternPose{{80, 60}, 0.0}; }).events(0.01, 1)) {
      tracker.push(event);
      for (const double score : tracker.scores().of) REQUIRE(std::isfinite(score));
    }
  }
}
