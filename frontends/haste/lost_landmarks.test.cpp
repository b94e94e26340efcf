#include "frontends/haste/lost_landmarks.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/support/index.hpp"
#include "core/testing/catch2.hpp"
#include "frontends/haste/tracking/testing/event_patterns.hpp"
#include "frontends/haste/tracking/tracker.hpp"

using namespace evbench;
using namespace evbench::haste;
using evbench::haste::testing::corner_lines;
using evbench::haste::testing::EventPattern;
using evbench::haste::testing::PatternPose;

namespace {

constexpr TrackId kTrack = 7;
const Vector2 kExpected(120.0, 90.0);  // [px] where the landmark is predicted

using Lines = std::vector<std::pair<Vector2, Vector2>>;

/// A row of upright lines 8 px apart: it matches equally well 8 px off.
Lines fence() {
  Lines lines;
  for (int k = -8; k <= 8; ++k) lines.push_back({{8.0 * k, -8.0}, {8.0 * k, 8.0}});
  return lines;
}

/// Events of lines about a place [px], turned [rad].
std::vector<Event> events(const Lines& lines, const Vector2& place, double angle = 0.0, std::uint64_t seed = 5) {
  EventPattern pattern;
  pattern.lines = lines;
  pattern.pose = [=](double) { return PatternPose{place, angle}; };
  pattern.noise = 0.0;
  return pattern.events(0.1, seed);
}

/// The template that a tracker on these lines has learnt.
Template look(const Lines& lines) {
  Tracker tracker({}, {0, kExpected, 0.0});
  for (const Event& event : events(lines, kExpected, 0.0, 6)) tracker.push(event);
  REQUIRE(tracker.running());
  return tracker.learnt_template();
}

/// A landmark that was lost at 0 s and is expected at kExpected, and recent events.
struct Setting {
  Camera camera;
  GuidanceOptions options;
  Matrix2 covariance = Matrix2::Identity();
  SE3 T_before, T_now;

  Setting() {
    camera.width = 240;
    camera.height = 180;
    camera.pinhole = {200.0, 200.0, 120.0, 90.0};
  }

  Guidance guidance() const { return guidance_at(T_now); }
  Guidance guidance_at(const SE3& T, std::size_t world = 0) const {
    Guidance result(camera, true);
    Feedback feedback;
    feedback.state = TrackingState::tracking;
    feedback.newest = ControlState{0.0, T, Vector6::Zero()};
    feedback.world = world;
    feedback.expected.push_back({kTrack, {0.0, 0.0, 2.0}, kExpected, covariance});
    result.receive(feedback);
    return result;
  }

  LostLandmarks lost(const Lines& lines) const {
    LostLandmarks result(options);
    result.remember(kTrack, 0.0, look(lines), 0.0, guidance_at(T_before));
    return result;
  }

  std::vector<LostLandmarks::Found> find(LostLandmarks& lost, const std::vector<Event>& seen, double t = 0.1,
                                         const std::vector<Vector2>& taken = {}) const {
    RecentEvents recent(15'000);
    recent.add(seen);
    return lost.find(guidance(), t, recent, {{}, taken}, 6.0, camera);
  }
  std::vector<LostLandmarks::Found> find(const Lines& lines, const std::vector<Event>& seen) const {
    LostLandmarks all = lost(lines);
    return find(all, seen);
  }
};

}  // namespace

TEST_CASE("A lost landmark is found at its true position, off the expected one") {
  const Setting setting;
  const Vector2 place = kExpected + Vector2(2.0, -1.0);
  const auto found = setting.find(corner_lines(), events(corner_lines(), place));
  REQUIRE(found.size() == 1);
  CHECK(found.front().track == kTrack);
  CHECK((found.front().pixel - place).norm() <= 1.0);
  CHECK(found.front().look.mass() > 0.0);
}

TEST_CASE("Events that do not match a lost landmark's template are not taken for it") {
  const Setting setting;
  const Lines other{{{-12, 3}, {-3, 12}}, {{3, -12}, {12, -3}}, {{4, 12}, {12, 4}}};
  CHECK(setting.find(corner_lines(), events(other, kExpected)).empty());
  // Too few events to decide.
  std::vector<Event> few = events(corner_lines(), kExpected);
  few.resize(kWindowSize / 2);
  CHECK(setting.find(corner_lines(), few).empty());
}

TEST_CASE("A template that matches two positions equally well is not found") {
  Setting setting;
  setting.covariance = 25.0 * Matrix2::Identity();
  for (std::uint64_t seed = 10; seed < 20; ++seed) {
    const std::vector<Event> seen = events(fence(), kExpected + Vector2(1.0, 0.0), 0.0, seed);
    CAPTURE(seed);
    setting.options.search = 11;
    CHECK(setting.find(fence(), seen).empty());
    setting.options.search = 5;  // no second match in reach
    CHECK(setting.find(fence(), seen).size() == 1);
  }
}

TEST_CASE("A match at the edge of the search is none, and the search reaches as far as the prediction is uncertain") {
  Setting setting;
  const auto at = [&](double x) { return events(corner_lines(), kExpected + Vector2(x, 0.0)); };
  REQUIRE(setting.options.search == 4);
  CHECK(setting.find(corner_lines(), at(2.0)).size() == 1);
  CHECK(setting.find(corner_lines(), at(4.0)).empty());
  CHECK(setting.find(corner_lines(), at(6.0)).empty());
  setting.options.search = 10;
  CHECK(setting.find(corner_lines(), at(4.0)).size() == 1);  // 2 px + 4 standard deviations
  CHECK(setting.find(corner_lines(), at(7.0)).empty());
  setting.covariance = 4.0 * Matrix2::Identity();
  CHECK(setting.find(corner_lines(), at(7.0)).size() == 1);
}

TEST_CASE("A lost landmark is searched for by its template as warped to the current pose") {
  Setting setting;
  Vector6 roll = Vector6::Zero();
  roll.z() = 1.0;
  setting.T_now = se3::exp(roll);  // the image turns in the other direction
  CHECK(setting.find(corner_lines(), events(corner_lines(), kExpected, -1.0)).size() == 1);
  CHECK(setting.find(corner_lines(), events(corner_lines(), kExpected, 0.0)).empty());
}

TEST_CASE("A lost landmark is not searched for near a tracked one, near the border, or without a motion estimate") {
  Setting setting;
  const std::vector<Event> seen = events(corner_lines(), kExpected);
  LostLandmarks lost = setting.lost(corner_lines());
  CHECK(setting.find(lost, seen, 0.1, {kExpected + Vector2(5.0, 0.0)}).empty());
  CHECK(setting.find(lost, seen, 0.2, {kExpected + Vector2(7.0, 0.0)}).size() == 1);

  RecentEvents recent(15'000);
  recent.add(seen);
  const Guidance nothing(setting.camera, true);
  CHECK(lost.find(nothing, 0.3, recent, {}, 6.0, setting.camera).empty());

  setting.camera.pinhole.cx = 10.0;
  CHECK(setting.find(lost, events(corner_lines(), {10.0, 90.0}), 0.4).empty());
}

TEST_CASE("A lost landmark is forgotten after a time or when it goes on, and not searched for soon after a mistake") {
  Setting setting;
  setting.options.memory = 2.0;
  const std::vector<Event> seen = events(corner_lines(), kExpected);
  LostLandmarks lost = setting.lost(corner_lines());
  CHECK(setting.find(lost, seen, 0.1).size() == 1);
  CHECK(setting.find(lost, seen, 0.11).empty());  // just searched for
  lost.disappoint(kTrack, 0.2);
  CHECK(setting.find(lost, seen, 0.6).empty());
  CHECK(setting.find(lost, seen, 0.8).size() == 1);
  CHECK(setting.find(lost, seen, 2.1).empty());  // longer ago than it is remembered

  LostLandmarks other = setting.lost(corner_lines());
  other.forget(kTrack);
  CHECK(setting.find(other, seen).empty());
  other.remember(kTrack, 0.0, Template{}, 0.0, setting.guidance_at({}));  // an empty template
  CHECK(setting.find(other, seen).empty());
}

TEST_CASE("Lost landmarks that are displaced together are found, those at their expected positions are not") {
  const Setting setting;
  Feedback feedback;
  feedback.state = TrackingState::tracking;
  feedback.newest = ControlState{};
  std::vector<Vector2> places;
  for (const double y : {50.0, 120.0}) {
    for (const double x : {50.0, 110.0, 170.0}) {
      const Vector2 place(x, y);
      const Vector3 position = 2.0 * setting.camera.pinhole.ray(place);
      feedback.expected.push_back({static_cast<TrackId>(places.size()), position, place, setting.covariance});
      places.push_back(place);
    }
  }
  Guidance guidance(setting.camera, true);
  guidance.receive(feedback);
  const auto find = [&](const GuidanceOptions& options, const Vector2& displacement) {
    std::vector<Event> seen;
    for (const Vector2& place : places) {
      const std::vector<Event> here = events(corner_lines(), place + displacement);
      seen.insert(seen.end(), here.begin(), here.end());
    }
    std::ranges::stable_sort(seen, {}, &Event::t);
    RecentEvents recent(15'000);
    recent.add(seen);
    LostLandmarks lost(options);
    for (std::size_t i = 0; i < places.size(); ++i) {
      lost.remember(static_cast<TrackId>(i), 0.0, look(corner_lines()), 0.0, guidance);
    }
    auto found = lost.find_displaced(guidance, 0.1, recent, {}, setting.camera);
    CHECK(lost.find_displaced(guidance, 0.11, recent, {}, setting.camera).empty());  // just searched for
    return found;
  };
  const Vector2 aside(11.0, 6.0);
  const auto found = find(setting.options, aside);
  CHECK(found.size() == places.size());
  for (const LostLandmarks::Found& one : found) CHECK((one.pixel - places[index(one.track)] - aside).norm() < 1.5);
  CHECK(find(setting.options, {1.0, 0.0}).empty());
  GuidanceOptions never = setting.options;
  never.displacement = 0;
  CHECK(find(never, aside).empty());
}

TEST_CASE("After tracking is lost, an earlier landmark is recognised wherever it is and however it is turned") {
  const Setting setting;
  const std::size_t now = 1;  // the number of the world
  const Vector2 place(60.0, 50.0);
  for (const double angle : {0.0, 0.3, -0.45}) {
    LostLandmarks lost = setting.lost(corner_lines());
    RecentEvents recent(15'000);
    recent.add(events(corner_lines(), place, angle));
    const auto found = lost.recognise(place + Vector2(2.0, -1.0), now, recent, 0.1, {});
    CAPTURE(angle);
    REQUIRE(found);
    CHECK(found->track == kTrack);
    CHECK((found->pixel - place).norm() <= 1.5);
    CHECK(found->look.mass() > 0.0);
    CHECK_FALSE(lost.recognise(place, 0, recent, 0.1, {}));                // the landmark is of this world
    CHECK_FALSE(lost.recognise(place, now, recent, 0.1, {{kTrack}, {}}));  // the landmark has a tracker
    CHECK_FALSE(lost.recognise({200.0, 150.0}, now, recent, 0.1, {}));     // no events there
    CHECK_FALSE(lost.recognise(place, now, recent, 100.0, {}));            // longer ago than it is remembered
  }
}

TEST_CASE("Of two landmarks with the same template none is recognised") {
  const Setting setting;
  LostLandmarks lost = setting.lost(corner_lines());
  CHECK(lost.has_of_another(1));
  CHECK_FALSE(lost.has_of_another(0));
  RecentEvents recent(15'000);
  recent.add(events(corner_lines(), kExpected));
  CHECK(lost.recognise(kExpected, 1, recent, 0.1, {}));
  lost.remember(kTrack + 1, 0.0, look(corner_lines()), 0.0, setting.guidance());
  CHECK_FALSE(lost.recognise(kExpected, 1, recent, 0.1, {}));
}

TEST_CASE("A landmark of a map that is gone is neither searched for nor recognised") {
  const Setting setting;
  LostLandmarks lost = setting.lost(corner_lines());
  const std::vector<Event> seen = events(corner_lines(), kExpected);
  RecentEvents recent(15'000);
  recent.add(seen);
  lost.forget_world(1);
  CHECK(setting.find(lost, seen).size() == 1);
  lost.forget_world(0);
  CHECK(setting.find(lost, seen, 0.2).empty());
  CHECK_FALSE(lost.has_of_another(1));
  CHECK_FALSE(lost.recognise(kExpected, 1, recent, 0.2, {}));
}

TEST_CASE("A landmark of another world is not searched for where this world's map expects it") {
  const Setting setting;
  LostLandmarks lost = setting.lost(corner_lines());
  RecentEvents recent(15'000);
  recent.add(events(corner_lines(), kExpected));
  CHECK(lost.find(setting.guidance_at(setting.T_now, 1), 0.1, recent, {}, 6.0, setting.camera).empty());
  CHECK(lost.find(setting.guidance(), 0.1, recent, {}, 6.0, setting.camera).size() == 1);
}
