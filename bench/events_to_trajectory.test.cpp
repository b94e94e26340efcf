#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "bench/runner.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/json.hpp"
#include "core/support/median.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/event_scene.hpp"
#include "eval/alignment.hpp"
#include "eval/latency.hpp"

// From events to a trajectory, with haste and gp_map, under difficult conditions.
using namespace evbench;
using evbench::testing::EventScene;
using evbench::testing::swing;

namespace {

Execution run(const Source& source, const Json& frontend = Json::object(), const std::string& mode = "sequential",
              const std::string& backend = "gp_map") {
  const Plugins plugins = registered_plugins();
  Job job;
  job.frontend = {"haste", plugins.of<FrontEnd>().find("haste", "").resolve(frontend, "haste", ""), "frontend"};
  job.backend = {backend, plugins.of<BackEnd>().find(backend, "").resolve(Json::object(), backend, ""), "backend"};
  job.pipeline.mode = mode;
  return execute(job, source, plugins, {});
}

/// The segment with most poses in a time span [s]; null if none has any.
const TrajectorySegment* segment_of(const RunResult& result, double from, double to = 1e9) {
  const TrajectorySegment* best = nullptr;
  std::ptrdiff_t most = 0;
  for (const TrajectorySegment& segment : result.segments) {
    const auto poses = std::ranges::count_if(segment.final_trajectory.poses(),
                                             [&](const StampedPose& pose) { return pose.t >= from && pose.t <= to; });
    if (poses > most) {
      most = poses;
      best = &segment;
    }
  }
  return best;
}

/// RMSE of the positions after a Sim(3) alignment, as a share of the path, in a time span [s], of the segment that
/// covers it. Poses within `without` are left out.
double error(const Source& source, const Execution& execution, double from = 0.0, double to = 1e9,
             const StationaryPeriod& without = {}) {
  constexpr double kNone = 1e9;
  const TrajectorySegment* segment = segment_of(execution.result, from, to);
  if (!segment) return kNone;
  std::vector<PosePair> pairs;
  double path = 0.0;
  for (const StampedPose& pose : segment->final_trajectory.poses()) {
    const auto T = source.ground_truth().pose(pose.t);
    if (!T || pose.t < from || pose.t > to || (pose.t > without.from && pose.t < without.to)) continue;
    if (!pairs.empty()) path += (pairs.back().ground_truth.p - T->p).norm();
    pairs.push_back({pose.t, *T, pose.T});
  }
  if (pairs.size() < 20) return kNone;
  const Alignment alignment = align(pairs, AlignmentMethod::sim3);
  double sum = 0.0;
  for (const PosePair& pair : pairs)
    sum += ((alignment.transform * pair.estimate).p - pair.ground_truth.p).squaredNorm();
  return std::sqrt(sum / static_cast<double>(pairs.size())) / path;
}

/// Checks that the run is complete and has a reason if it is not ok, that one segment covers the time from `from` [s]
/// to the end with a small error, and that memory is bounded.
void check_recovered(const Source& source, const Execution& execution, double from) {
  constexpr double kMostError = 0.03;                   // of the path
  [[maybe_unused]] constexpr double kMostMemory = 400;  // [MiB], of which a scene's events are up to 60
  constexpr double kMissing = 0.3;                      // [s], after `from` and at the end: a new map takes some time
  const RunResult& result = execution.result;
  CAPTURE(from, to_string(result.status.state), result.status.reason, result.segments.size());
  REQUIRE(execution.complete);
  CHECK((result.status.state == RunState::ok) == result.status.reason.empty());
  const TrajectorySegment* segment = segment_of(result, from);
  REQUIRE(segment);
  CHECK(segment->final_trajectory.start() < from + kMissing);
  CHECK(segment->final_trajectory.end() > source.time_range().to - kMissing);
  CHECK(error(source, execution, from) < kMostError);
#if !defined(EVBENCH_SANITIZED)
  CHECK(result.peak_rss_mib < kMostMemory);
#endif
}

/// Number of re-acquired landmarks whose tracks were continued, from the front-end's remark.
int continued_tracks(const Execution& execution) {
  int found = 0, count = 0;
  for (const std::string& line : execution.result.log) {
    const int read =
        std::sscanf(line.c_str(), "frontend: %d landmarks re-acquired by template, of which %d were", &found, &count);
    if (read == 2) return count;
  }
  FAIL("the front-end does not say how many landmarks were confirmed");
  return 0;
}

const std::vector<EventScene::Outline>& wall() {
  static const auto result = EventScene::quadrangles(150, 1);
  return result;
}

/// A repetitive texture.
std::vector<EventScene::Outline> tiles() {
  std::vector<EventScene::Outline> result;
  for (int i = -12; i <= 12; ++i) {
    for (int k = -9; k <= 9; ++k) {
      const Vector2 c(0.25 * i, 0.25 * k);
      result.push_back(
          {c + Vector2(-0.06, -0.06), c + Vector2(0.06, -0.06), c + Vector2(0.06, 0.06), c + Vector2(-0.06, 0.06)});
    }
  }
  return result;
}

}  // namespace

TEST_CASE("From events to a trajectory: a swinging camera in front of a wall, with identical results in two threads",
          "[slow]") {
  const EventScene scene(swing, 4.0, wall());
  const Execution sequential = run(scene);
  CHECK(sequential.result.status.state == RunState::ok);
  CHECK(error(scene, sequential) < 0.01);
  const Execution concurrent = run(scene, Json::object(), "concurrent");
  CHECK(concurrent.result.tracks_sha256 == sequential.result.tracks_sha256);
  REQUIRE(concurrent.result.segments.size() == 1);
  CHECK(std::ranges::equal(
      concurrent.result.segments[0].final_trajectory.poses(), sequential.result.segments[0].final_trajectory.poses(),
      {}, [](const StampedPose& pose) { return std::pair(pose.t, pose.T.p); },
      [](const StampedPose& pose) { return std::pair(pose.t, pose.T.p); }));
}

TEST_CASE("Causal poses are at most a tenth of a second old while there is something to track", "[slow]") {
  constexpr double kDelay = 0.03;  // [s], of haste's observations
  const EventScene scene(swing, 3.0, wall());
  for (const char* backend : {"gp_map", "bundle_adjustment"}) {
    const Execution execution = run(scene, Json::object(), "sequential", backend);
    REQUIRE(execution.result.segments.size() == 1);
    const auto& published = execution.result.segments[0].published;
    const std::optional<Delay> delay = delay_of(published);
    CAPTURE(backend);
    REQUIRE(delay);
    CHECK(delay->median >= kDelay - 1e-6);
    CHECK(delay->median <= 0.07);
    CHECK(delay->p99 <= 0.1);
    CHECK(delay->max <= 0.1);
    // Nor are there gaps between published poses: from the first pose on there is always a recent one.
    double before = published.front().t;
    for (const CausalPose& pose : published) {
      if (pose.t <= before) continue;
      CHECK(pose.t - before < 0.1);
      before = pose.t;
    }
    CHECK(before > 2.9);
  }
}

TEST_CASE("Landmarks that return into view are re-associated, and their tracks are continued", "[long]") {
  // Away to the right, and back: the first landmarks are out of view in between.
  const auto motion = [](double t) {
    SE3 T = swing(t);
    T.p.x() += 0.9 * (1.0 - std::cos(1.6 * t));
    return T;
  };
  const EventScene scene(motion, 6.0, wall());
  const Execution with = run(scene), without = run(scene, parse_json(R"({"guidance": {"reacquire": false}})"));
  const auto tracks = [&](const Execution& execution) { return execution.result.segments.at(0).map.size(); };
  CHECK(tracks(with) < tracks(without));
  CHECK(error(scene, with) < error(scene, without));
}

TEST_CASE("Five seconds without events are a stationary period, and the trajectory continues", "[slow]") {
  const auto motion = [](double t) { return swing(t < 2.0 ? t : std::max(2.0, t - 5.0)); };
  const EventScene scene(motion, 9.0, wall());
  const Execution execution = run(scene);
  CHECK(execution.result.status.state == RunState::ok);
  CHECK(execution.result.segments.size() == 1);
  CHECK_FALSE(execution.result.stationary.empty());
  CHECK(error(scene, execution) < 0.02);
  check_recovered(scene, execution, 7.0);
}

TEST_CASE("After the last event a camera is stationary, unless the recording may have been truncated", "[long]") {
  const auto motion = [](double t) { return swing(std::min(t, 3.0)); };
  EventScene scene(motion, 7.0, wall());
  const Execution still = run(scene);
  CHECK(still.result.status.state == RunState::ok);
  REQUIRE(still.result.segments.size() == 1);
  CHECK(still.result.segments[0].final_trajectory.end() > 6.9);
  REQUIRE_FALSE(still.result.stationary.empty());
  CHECK(still.result.stationary.back().to > 6.9);

  scene.cut_off();
  for (const char* mode : {"sequential", "concurrent"}) {
    const Execution over = run(scene, Json::object(), mode);
    CHECK(over.result.status.state == RunState::ok);
    CHECK(over.result.stationary.empty());
    REQUIRE(over.result.segments.size() == 1);
    CHECK(over.result.segments[0].final_trajectory.end() == Approx(3.0).margin(0.1));
    CHECK(std::ranges::any_of(over.result.log, [](const std::string& line) {
      return line.find("the events end at ") != std::string::npos && line.find("7.000 s") != std::string::npos;
    }));
  }
}

TEST_CASE("A sensor failure while the camera moves is reported, and the run is relocalised in the same world",
          "[long]") {
  for (const double silence : {2.0, 3.0, 5.0}) {
    for (const std::uint64_t seed : {1, 2}) {
      EventScene scene(swing, silence + 6.0, EventScene::quadrangles(150, seed));
      const StationaryPeriod gap{2.5, 2.5 + silence};
      scene.silence(gap.from, gap.to);
      const Execution execution = run(scene);
      const RunResult& result = execution.result;
      CAPTURE(silence, seed, result.status.reason);
      CHECK(result.stationary.empty());
      CHECK(result.status.state == RunState::degraded);
      CHECK(result.status.reason ==
            "lost: the camera moved while nothing was seen; then relocalised in the same world");
      REQUIRE(result.segments.size() == 1);
      check_recovered(scene, execution, gap.to + 1.0);
      CHECK(error(scene, execution, 0.0, 1e9, gap) < 0.015);
      CHECK(std::ranges::none_of(result.segments[0].final_trajectory.poses(),
                                 [&](const StampedPose& pose) { return pose.t > gap.from + 0.2 && pose.t < gap.to; }));
    }
  }
}

TEST_CASE("After a sensor failure a repetitive texture or another place gives no relocalisation", "[long]") {
  std::vector<EventScene::Outline> far = wall();
  for (const EventScene::Outline& outline : EventScene::quadrangles(150, 2)) {
    far.push_back(outline);
    for (Vector2& corner : far.back()) corner.x() += 10.0;
  }
  const auto away = [](double t) {
    SE3 T = swing(t);
    if (t > 3.5) T.p.x() += 10.0;
    return T;
  };
  const EventScene scenes[] = {EventScene(swing, 8.0, tiles()), EventScene(away, 8.0, far)};
  for (EventScene scene : scenes) {
    scene.silence(2.5, 4.5);
    const Execution execution = run(scene);
    check_recovered(scene, execution, 5.5);
    CHECK(execution.result.status.state == RunState::lost);
    CHECK(execution.result.segments.size() == 2);
  }
}

TEST_CASE("A burst of a million events in 10 ms does no lasting harm", "[slow]") {
  EventScene scene(swing, 4.0, wall());
  Random random(3);
  std::vector<Event> burst(1'000'000);
  for (std::size_t i = 0; i < burst.size(); ++i) {
    burst[i] = {2'000'000 + static_cast<std::int64_t>(i / 100), static_cast<std::uint16_t>(random.index(240)),
                static_cast<std::uint16_t>(random.index(180)), i % 2 == 0};
  }
  scene.add(burst);
  const Execution execution = run(scene);
  check_recovered(scene, execution, 2.2);
  CHECK(error(scene, execution, 0.0, 2.0) < 0.02);  // before the burst
  CHECK(error(scene, execution) < 0.02);            // both parts are consistent
}

TEST_CASE("A camera that sees only noise for a short time, and loses all trackers, continues in the same map",
          "[long]") {
  constexpr double kGap = 0.2;  // [s]
  std::vector<double> errors;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    EventScene scene(swing, 5.0, EventScene::quadrangles(150, seed));
    scene.silence(3.0, 3.0 + kGap);
    Random random(seed);
    std::vector<Event> noise(static_cast<std::size_t>(1e6 * kGap));
    for (std::size_t i = 0; i < noise.size(); ++i) {
      noise[i] = {3'000'000 + static_cast<std::int64_t>(i), static_cast<std::uint16_t>(random.index(240)),
                  static_cast<std::uint16_t>(random.index(180)), true};
    }
    scene.add(noise);
    const Execution execution = run(scene);
    CAPTURE(seed, execution.result.status.reason);
    CHECK(execution.result.segments.size() == 1);
    CHECK(execution.result.status.state != RunState::lost);
    errors.push_back(error(scene, execution));
    if (seed <= 2 || execution.result.status.state == RunState::ok) CHECK(errors.back() < 0.03);
  }
  CHECK(median(errors) < 0.015);
}

TEST_CASE("Hot pixels that fire five hundred times a second do no harm", "[slow]") {
  EventScene scene(swing, 4.0, wall());
  std::vector<Event> hot;
  for (int i = 0; i < 20; ++i) {
    for (std::int64_t t = 137 * i; t < 4'000'000; t += 2'000) {
      hot.push_back({t, static_cast<std::uint16_t>(11 * i % 240), static_cast<std::uint16_t>(37 * i % 180), true});
    }
  }
  scene.add(hot);
  const Execution execution = run(scene);
  CHECK(execution.result.status.state == RunState::ok);
  CHECK(error(scene, execution) < 0.01);
  check_recovered(scene, execution, 0.5);
}

TEST_CASE("A light that flickers for a second over half of all pixels does no lasting harm", "[slow]") {
  EventScene scene(swing, 5.0, wall());
  std::vector<Event> flicker;
  for (std::int64_t t = 2'000'000; t < 3'000'000; t += 10'000) {  // at 100 Hz
    for (int y = 0; y < 180; ++y) {
      for (int x = y % 2; x < 240; x += 2) {  // as a checkerboard
        flicker.push_back({t + (x * 7 + y * 13) % 1000, static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                           t % 20'000 == 0});
      }
    }
  }
  scene.add(flicker);
  const Execution execution = run(scene);
  check_recovered(scene, execution, 3.3);
  CHECK(error(scene, execution, 0.0, 2.0) < 0.02);
}

TEST_CASE("A camera that is stationary for the first ten seconds is initialised when it moves", "[slow]") {
  const auto motion = [](double t) { return swing(std::max(0.0, t - 10.0)); };
  const EventScene scene(motion, 13.0, wall());
  const Execution execution = run(scene);
  CHECK(execution.result.status.state == RunState::ok);
  CHECK(error(scene, execution, 10.0) < 0.02);
}

TEST_CASE("Pure rotation gives no map, with a reason, and once the camera translates, there is one", "[slow]") {
  const auto turn = [](double t) {
    Vector6 twist = Vector6::Zero();
    twist.head<3>() = Vector3(0.1 * std::sin(2.0 * t), 0.15 * std::sin(1.5 * t), 0.2 * std::sin(t));
    return se3::exp(twist);
  };
  const EventScene rotating(turn, 3.0, wall());
  const Execution nothing = run(rotating);
  REQUIRE(nothing.complete);
  CHECK(nothing.result.status.state == RunState::failed);
  CHECK_FALSE(nothing.result.status.reason.empty());

  const auto later = [&](double t) { return turn(t) * swing(std::max(0.0, t - 2.0)); };
  const EventScene translating(later, 6.0, wall());
  const Execution execution = run(translating);
  REQUIRE_FALSE(execution.result.segments.empty());
  CHECK(error(translating, execution, 2.5) < 0.02);
}

TEST_CASE("An empty scene ends with a reason, and once there is texture, there is a trajectory", "[slow]") {
  const EventScene empty(swing, 1.0, {});
  const Execution nothing = run(empty);
  REQUIRE(nothing.complete);
  CHECK(nothing.result.status.state == RunState::failed);
  CHECK_FALSE(nothing.result.status.reason.empty());

  EventScene later(swing, 5.0, wall());
  later.silence(0.0, 2.0);
  check_recovered(later, run(later), 2.5);
}

TEST_CASE("A single straight edge ends with a reason, and once there is more texture, there is a trajectory",
          "[slow]") {
  const std::vector<EventScene::Outline> line{{{-4.0, -0.2}, {4.0, 0.3}}};
  const EventScene edge(swing, 3.0, line);
  const Execution nothing = run(edge);
  REQUIRE(nothing.complete);
  CHECK(nothing.result.status.state != RunState::ok);
  CHECK_FALSE(nothing.result.status.reason.empty());

  EventScene later(swing, 6.0, wall());
  later.silence(0.0, 3.0);
  later.add(edge.list);
  check_recovered(later, run(later), 3.5);
}

TEST_CASE("A repetitive texture causes no wrong re-associations", "[long]") {
  const auto motion = [](double t) {
    SE3 T = swing(t);
    T.p.x() += 0.6 * (1.0 - std::cos(1.6 * t));
    return T;
  };
  const EventScene scene(motion, 5.0, tiles());
  const Execution with = run(scene), without = run(scene, parse_json(R"({"guidance": {"reacquire": false}})"));
  CHECK(with.result.status.state == RunState::ok);
  check_recovered(scene, with, 0.5);
  CHECK(continued_tracks(with) > 0);
  CHECK(continued_tracks(without) == 0);
  CHECK(error(scene, with) < 0.02);
  CHECK(error(scene, with) <= error(scene, without));
}

TEST_CASE("A hand that moves in front of the camera rarely harms the estimate", "[long]") {
  constexpr std::uint64_t kHands = 5;  // of seeds 1 to 20 none does: all end within 0.4 % of the path
  std::vector<double> errors;
  for (std::uint64_t seed = 9; seed < 9 + kHands; ++seed) {
    EventScene scene(swing, 4.0, wall());
    // Seen from a camera that swings faster: 30 quadrangles in the image's left part.
    const auto other = [](double t) { return swing(2.5 * t + 1.0); };
    const EventScene hand(other, 3.0, EventScene::quadrangles(60, seed));
    std::vector<Event> moving;
    for (const Event& event : hand.list) {
      if (event.t > 1'500'000 && event.x < 70) moving.push_back(event);
    }
    std::erase_if(scene.list,
                  [](const Event& event) { return event.t > 1'500'000 && event.t < 3'000'000 && event.x < 70; });
    scene.add(moving);
    const Execution execution = run(scene);
    REQUIRE(execution.complete);
    CHECK(execution.result.status.state == RunState::ok);
    errors.push_back(error(scene, execution));
  }
  CHECK(median(errors) < 0.01);
  CHECK(std::ranges::count_if(errors, [](double e) { return e < 0.01; }) >= 4);  // one may be harmed
}

TEST_CASE("Events out of order, repeated, at the border or outside the sensor do no harm", "[slow]") {
  EventScene scene(swing, 3.0, wall());
  std::vector<Event> more;
  for (std::size_t i = 0; i < scene.list.size(); i += 50) {
    more.push_back(scene.list[i]);                                                      // twice
    more.push_back({scene.list[i].t, 239, static_cast<std::uint16_t>(i % 180), true});  // at the border
    more.push_back({scene.list[i].t, 400, 3, true});                                    // outside
  }
  scene.add(more);
  for (std::size_t i = 1000; i + 1 < scene.list.size(); i += 1000) std::swap(scene.list[i], scene.list[i - 200]);
  const Execution execution = run(scene);
  CHECK(execution.result.status.state == RunState::ok);
  CHECK(error(scene, execution) < 0.01);
}
