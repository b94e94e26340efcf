#include "frontends/haste/tracking/tracker_set.hpp"

#include <tbb/global_control.h>

#include <map>
#include <utility>

#include "core/testing/catch2.hpp"
#include "frontends/haste/tracking/testing/event_patterns.hpp"

using namespace evbench;
using namespace evbench::haste;
using namespace evbench::haste::testing;

namespace {

bool same(const Change& a, const Change& b) {
  const auto states = [](const TrackerState& p, const TrackerState& q) {
    return p.t == q.t && p.position == q.position && p.angle == q.angle;
  };
  return a.tracker == b.tracker && a.t_event == b.t_event && states(a.before, b.before) && states(a.after, b.after) &&
         a.scores.of == b.scores.of;
}

/// Many lines all over a 100 × 80 sensor and beyond it, which move at `speed` [px/s].
std::vector<Event> flying_lines(double speed, std::uint64_t seed) {
  Random random(seed);
  EventPattern pattern;
  for (int i = 0; i < 40; ++i) {
    const Vector2 from = random.uniform2({-80.0, -60.0}, {80.0, 60.0});
    pattern.lines.emplace_back(from, from + random.uniform2({-15.0, -15.0}, {15.0, 15.0}));
  }
  pattern.pose = [=](double t) { return PatternPose{{50 + speed * t, 40 - 0.4 * speed * t}, 1.5 * t}; };
  pattern.rate = 400e3;
  pattern.width = 100;
  pattern.height = 80;
  return pattern.events(0.1, seed);
}

/// Every tracker sees every event.
class BruteForce {
 public:
  void add(std::int64_t id, const TrackerState& seed) { trackers_.emplace(id, Tracker({}, seed)); }
  void remove(std::int64_t id) { trackers_.erase(id); }
  void push(std::span<const Event> events, std::vector<Change>& changes) {
    for (const Event& event : events) {
      for (auto& [id, tracker] : trackers_) {
        const auto update = tracker.push(event);
        if (update != Tracker::Update::changed && update != Tracker::Update::started) continue;
        changes.push_back(tracker.change());
        changes.back().tracker = id;
      }
    }
  }
  const Tracker& tracker(std::int64_t id) const { return trackers_.at(id); }

 private:
  std::map<std::int64_t, Tracker> trackers_;
};

}  // namespace

TEST_CASE("A set has each tracker's changes on all events, however events are divided, in one thread or in three") {
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  for (const double speed : {50.0, 2000.0}) {
    for (const auto& [cut, threads] : {std::pair(1UL, 1), {777UL, 1}, {777UL, 3}, {100'000UL, 1}, {100'000UL, 3}}) {
      const std::vector<Event> events = flying_lines(speed, 3);
      Random random(4);
      TrackerSet set(100, 80, threads);
      BruteForce brute_force;
      std::vector<Change> changes, expected;
      const auto add = [&] {
        const TrackerState seed{0, {random.uniform(-5.0, 105.0), random.uniform(-5.0, 85.0)}, 0.0};
        brute_force.add(set.add(Tracker({}, seed)), seed);
      };
      for (int i = 0; i < 70; ++i) add();  // more than a word of them
      for (const std::size_t half : {std::size_t{0}, events.size() / 2}) {
        const std::size_t end = half == 0 ? events.size() / 2 : events.size();
        for (std::size_t i = half; i < end; i += cut) {
          const auto some = std::span(events).subspan(i, std::min(cut, end - i));
          set.push(some, changes);
          brute_force.push(some, expected);
        }
        for (const std::int64_t id : {3, 40, 66}) {
          if (half != 0) break;
          set.remove(id);
          brute_force.remove(id);
          add();
        }
      }
      REQUIRE(changes.size() == expected.size());
      CHECK(changes.size() > 70);
      CHECK(std::ranges::equal(changes, expected, same));
      for (const std::int64_t id : set.ids()) {
        CHECK(set.tracker(id).event_count() == brute_force.tracker(id).event_count());
        CHECK(set.tracker(id).scores().of == brute_force.tracker(id).scores().of);
      }
    }
  }
}

TEST_CASE("Ids count up and are not used again") {
  TrackerSet set(240, 180);
  CHECK(set.add(Tracker({}, {0, {20, 20}, 0.0})) == 0);
  CHECK(set.add(Tracker({}, {0, {30, 20}, 0.0})) == 1);
  set.remove(0);
  CHECK(set.add(Tracker({}, {0, {20, 20}, 0.0})) == 2);
  CHECK(set.ids() == std::vector<std::int64_t>{1, 2});
  CHECK(set.size() == 2);
  CHECK_THROWS_AS(set.tracker(0), std::out_of_range);
}

TEST_CASE("Events outside the sensor reach no tracker, and a tracker may be outside") {
  TrackerSet set(100, 80);
  const std::int64_t inside = set.add(Tracker({}, {0, {95, 75}, 0.0}));
  const std::int64_t outside = set.add(Tracker({}, {0, {-300, 500}, 0.0}));
  std::vector<Change> changes;
  const std::vector<Event> events{{0, 100, 75, true}, {1, 99, 79, true}, {2, 65535, 65535, true}, {3, 0, 79, true}};
  set.push(events, changes);
  CHECK(set.tracker(inside).event_count() == 1);
  CHECK(set.tracker(outside).event_count() == 0);
  set.push({}, changes);
  CHECK(changes.empty());
}
