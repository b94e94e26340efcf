#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "backends/gp_map/gp_map.hpp"
#include "backends/gp_map/testing/tracked_scene.hpp"
#include "core/support/index.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {

using testing::TrackedScene;

TEST_CASE(
    "Of re-acquired landmarks as many continue as the budget allows, and the others become new ones at the same place",
    "[long]") {
  const TrackedScene scene(8.0, R"({"tracks": {"lifetime": [6.0, 8.0]}})");
  constexpr double kPeriod = 2.0, kGone = 0.7;  // [s]
  const auto phase = [](const UndistortedObservation& z) { return z.t + 0.37 * static_cast<double>(z.track); };
  const auto is_seen = [&](const UndistortedObservation& z) { return std::fmod(phase(z), kPeriod) > kGone; };
  const auto landmarks_with = [&](int returns) {
    BackEndContext context;
    context.camera = scene.camera();
    Options options;
    options.reassociation.returns = returns;
    GpMap backend(options, context);
    std::map<TrackId, double> last;
    UndistortedBatch batch;
    for (const UndistortedObservation& z : scene.observations()) {
      if (!is_seen(z)) continue;
      last[z.track] = z.t;
      for (auto i = last.begin(); i != last.end();) {
        const bool gone = z.t > i->second + 0.2;
        if (gone) batch.ended.push_back({i->first, z.t});
        i = gone ? last.erase(i) : std::next(i);
      }
      batch.observations.push_back(z);
      if (z.t < batch.until + 0.05) continue;
      batch.until = z.t;
      backend.advance(batch);
      batch = {{}, {}, batch.until};
    }
    backend.finish();
    CHECK(backend.status().state == RunState::ok);
    std::vector<StampedPose> poses;
    for (const StampedPose& pose : backend.trajectory().poses()) poses.push_back(pose);
    const Scores scores =
        score(scene.ground_truth(), PoseTrajectory(std::move(poses)), {.association = "interpolated"});
    CHECK(scores.ate.trans_percent < 0.5);
    std::vector<int> over(backend.graph().states.size());
    for (const FactorGraph::Landmark& landmark : backend.graph().landmarks) {
      for (std::size_t i = 1; i < landmark.intervals.size(); ++i) {
        const int from = landmark.intervals[i - 1], to = landmark.intervals[i];
        const double gap = backend.graph().states[index(to - 1)].t - backend.graph().states[index(from)].t;
        for (int k = from; gap > 0.5 && k < to; ++k) ++over[index(k)];
      }
    }
    CHECK(std::ranges::max(over) <= returns);
    return backend.graph().landmarks.size();
  };
  const std::size_t none = landmarks_with(0), some = landmarks_with(8), all = landmarks_with(1000);
  CHECK(none > some + 10);
  CHECK(some > all + 10);
}

TEST_CASE("A track that is re-acquired off its landmark is reported as an outlier, and the landmark can return later",
          "[slow]") {
  constexpr double kGone = 6.5, kDisplaced = 7.0, kGoneAgain = 7.5, kBack = 8.0, kUntil = 10.0;  // [s]
  const TrackedScene scene(kUntil, R"({"tracks": {"lifetime": [9.5, 10.0]}})");
  const auto is_mismatched = [](TrackId track) { return track % 30 == 7; };
  BackEndContext context;
  context.camera = scene.camera();
  GpMap backend({}, context);
  std::set<TrackId> before, displaced, after, reported;
  std::set<TrackId> live;
  UndistortedBatch batch;
  for (UndistortedObservation z : scene.observations()) {
    if (is_mismatched(z.track)) {
      if ((z.t > kGone && z.t < kDisplaced) || (z.t > kGoneAgain && z.t < kBack)) {
        if (live.erase(z.track) > 0) batch.ended.push_back({z.track, z.t});
        continue;
      }
      live.insert(z.track);
      if (z.t < kGone - 1.0) before.insert(z.track);
      if (z.t > kBack) after.insert(z.track);
      if (z.t > kDisplaced && z.t < kBack) {
        displaced.insert(z.track);
        z.pixel += Vector2(12.0, 5.0 * std::sin(z.track));
      }
    }
    batch.observations.push_back(z);
    if (z.t < batch.until + 0.05) continue;
    batch.until = z.t;
    backend.advance(batch);
    for (const TrackId track : backend.feedback({.any = true}).outliers) reported.insert(track);
    batch = {{}, {}, batch.until};
  }
  std::vector<TrackId> all_the_time;
  for (const TrackId track : before) {
    if (displaced.contains(track) && after.contains(track)) all_the_time.push_back(track);
  }
  CHECK(all_the_time.size() >= 2);
  for (const TrackId track : all_the_time) CHECK(reported.contains(track));
  const auto time = [&](int k) { return backend.graph().states[index(k)].t; };
  const auto comes_back = [&](const FactorGraph::Landmark& landmark) {
    return std::ranges::adjacent_find(landmark.intervals, [&](int a, int b) {
             return time(a) < kDisplaced && time(b) > kBack;
           }) != landmark.intervals.end();
  };
  CHECK(std::ranges::count_if(backend.graph().landmarks, comes_back) == std::ssize(all_the_time));
  CHECK(backend.status().state == RunState::ok);
}

TEST_CASE("A track that ends and is seen again before the next state has not ended", "[slow]") {
  const TrackedScene scene(4.0);
  const auto landmarks = [&](bool flickering) {
    BackEndContext context;
    context.camera = scene.camera();
    Options options;
    options.reassociation.returns = 1000;
    GpMap backend(options, context);
    UndistortedBatch batch{scene.observations(), {}, scene.duration()};
    std::set<TrackId> seen;
    for (const UndistortedObservation& z : batch.observations) {
      if (!seen.insert(z.track).second && flickering) batch.ended.push_back({z.track, z.t - 1e-6});
    }
    backend.advance(batch);
    CHECK(backend.status().state == RunState::ok);
    return backend.graph().landmarks.size();
  };
  CHECK(landmarks(true) == landmarks(false));
}

}  // namespace evbench::gp_map
