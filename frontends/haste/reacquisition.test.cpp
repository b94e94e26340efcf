#include <algorithm>
#include <map>
#include <optional>

#include "core/testing/catch2.hpp"
#include "core/testing/event_scene.hpp"
#include "frontends/haste/haste.hpp"

// The feedback is made by hand: it has the true motion, and of landmarks what a test needs.
using namespace evbench;
using namespace evbench::haste;
using evbench::testing::EventScene;
using evbench::testing::swing;

namespace {

constexpr double kStep = 0.01;  // [s] between two exchanges

const EventScene& lost_scene() {
  static const EventScene result(swing, 1.0, EventScene::quadrangles(150, 1));
  return result;
}

using Landmarks = std::map<TrackId, Vector3>;

/// The points of the wall at which tracks begin without feedback, by the ids that they then have.
const Landmarks& beginnings() {
  static const Landmarks result = [] {
    Landmarks points;
    Haste haste({}, {lost_scene(), 0, ""});
    TrackBatch batch;
    for (double t = kStep; t < 0.5; t += kStep) {
      haste.advance({t}, batch);
      for (const TrackObservation& z : batch.observations) {
        const SE3 T = swing(z.t);
        const Vector3 ray = T.R() * lost_scene().camera().pinhole.ray(z.pixel);
        points.try_emplace(z.track, T.p + (EventScene::kDistance - T.p.z()) / ray.z() * ray);
      }
    }
    return points;
  }();
  return result;
}

Feedback feedback(double t, TrackingState state, const Landmarks& landmarks, double sigma) {
  constexpr double kShort = 1e-4;  // [s]
  Feedback result;
  result.t = t;
  result.state = state;
  const Vector6 velocity = se3::log(swing(t - kShort).inverse() * swing(t + kShort)) / (2.0 * kShort);
  result.newest = ControlState{t, swing(t), velocity};
  for (const auto& [track, position] : landmarks) {
    const Vector2 pixel = lost_scene().camera().project(swing(t).inverse() * position);
    result.expected.push_back({track, position, pixel, sigma * sigma * Matrix2::Identity()});
  }
  return result;
}

struct Reported {
  std::string trackers, finds;  ///< remarks
};

/// What it reports after a second with feedback from `from` [s] on. `sigma` [px]: the positions' uncertainty in the
/// feedback. One feedback of `state`, if there is one, comes first.
Reported track(const Options& options, const Landmarks& landmarks, TrackingState state = TrackingState::tracking,
               double sigma = 0.5, double from = kStep, std::optional<TrackingState> before = std::nullopt) {
  Haste haste(options, {lost_scene(), 0, ""});
  Reported reported;
  TrackBatch batch;
  for (double t = kStep; t < 1.0; t += kStep) {
    if (t >= from && before) haste.receive(feedback(t, *before, {}, sigma));
    if (t >= from) haste.receive(feedback(t, state, landmarks, sigma));
    haste.advance({t}, batch);
  }
  const std::vector<std::string> remarks = haste.remarks();
  for (const std::string& remark : remarks) {
    if (remark.starts_with("trackers that ended")) reported.trackers = remark;
    if (remark.find("landmarks re-acquired") != std::string::npos) reported.finds = remark;
  }
  return reported;
}

}  // namespace

TEST_CASE("Landmarks are re-acquired while the back-end is degraded, unless that is switched off or tracking is lost",
          "[slow]") {
  Options on;
  on.life.border = 40.0;  // trackers end where what they were on is still in view
  Options off = on;
  off.guidance.degraded = false;
  const auto none = Catch::Matchers::StartsWith("0 landmarks re-acquired");
  CHECK_THAT(track(on, beginnings(), TrackingState::degraded).finds, !none);
  CHECK_THAT(track(off, beginnings(), TrackingState::degraded).finds, none);
  CHECK_THAT(track(on, beginnings(), TrackingState::lost).finds, none);
}

TEST_CASE("A landmark of a map that is replaced is not searched for in the next one", "[slow]") {
  Options options;
  options.life.border = 40.0;  // trackers end where what they were on is still in view
  const auto finds = [&](TrackingState before) {
    return track(options, beginnings(), TrackingState::tracking, 0.5, kStep, before).finds;
  };
  CHECK_THAT(finds(TrackingState::degraded), !Catch::Matchers::StartsWith("0 landmarks re-acquired"));
  CHECK_THAT(finds(TrackingState::no_map), Catch::Matchers::StartsWith("0 landmarks re-acquired"));
}

TEST_CASE("Trackers far from where landmarks are expected end, but not while a motion model alone expects them there") {
  Landmarks landmarks = beginnings();
  int moved = 0;
  for (auto& [id, position] : landmarks) {
    if (id % 8 != 0) continue;
    position.x() += 0.12;  // 12 px
    ++moved;
  }
  REQUIRE(moved > 3);
  Options options;
  options.guidance.degraded = true;
  CHECK_THAT(track(options, landmarks, TrackingState::tracking, 0.5, 0.6).trackers,
             !Catch::Matchers::ContainsSubstring(" 0 far from where they were expected"));
  CHECK_THAT(track(options, landmarks, TrackingState::degraded, 0.5, 0.6).trackers,
             Catch::Matchers::ContainsSubstring(" 0 far from where they were expected"));
}

TEST_CASE("Lost landmarks that are displaced together are re-associated, unless that is switched off", "[slow]") {
  Landmarks landmarks = beginnings();
  for (auto& [id, position] : landmarks) {
    if (id % 2 != 0) position.x() += 0.1;  // 10 px; the others determine the camera's pose
  }
  Options on;
  on.life.border = 40.0;  // trackers end where what they were on is still in view
  Options off = on;
  off.guidance.displacement = 0;
  CHECK_THAT(track(on, landmarks).finds, !Catch::Matchers::ContainsSubstring(" 0 displaced together"));
  CHECK_THAT(track(off, landmarks).finds, Catch::Matchers::ContainsSubstring(" 0 displaced together"));
  CHECK_THAT(track(on, beginnings()).finds, Catch::Matchers::ContainsSubstring(" 0 displaced together"));
}
