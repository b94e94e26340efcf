// Cost of tracking, and errors of tracks:
//
//   haste_micro [SECONDS [TRAJECTORY [START [SCENE [VARIANT [THREADS]]]]]]
//
// of simulated events: a 240x180 sensor that sees SCENE (plane) along a file's motion from START [s] on (EVBENCH_DATA's
// haste_simulated/dynamic_plane, 0). 60 trackers are kept alive: seeds by cv::goodFeaturesToTrack on the image of the
// last 15,000 events, 15 px apart; ended 15 px from the border and where the scores' spread is below 0.1
// (correlations). Only variants whose names contain VARIANT are measured. A variant's time is that of TrackerSet::push
// alone, of the processor with one thread and by the clock with more, of each call (10,000 events) the least of seven
// equal runs; with that of the plain transcription on the events of some of the trackers. Errors: of each change
// of state against the true track of the point at which its tracker started, median over those between 0.1 and 0.2 s
// later.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/simulation/events/event_simulator.hpp"
#include "core/simulation/events/scene_brightness.hpp"
#include "core/simulation/events/scene_truth.hpp"
#include "eval/quantile.hpp"
#include "frontends/haste/tracking/testing/plain_tracker.hpp"
#include "frontends/haste/tracking/tracker_set.hpp"

namespace {

using namespace evbench;
using namespace evbench::haste;

constexpr int kWidth = 240, kHeight = 180;
constexpr std::size_t kTrackers = 60, kImageEvents = 15'000;
constexpr std::size_t kCall = 10'000;  // events that a set is given at a time
constexpr int kRuns = 7;
constexpr int kMargin = kPatchRadius;  // [px]

/// Processor time with one thread, as the machine may have other work, else time by the clock [s].
double now(int threads) {
  timespec time{};
  clock_gettime(threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Recording {
  std::vector<Event> events;
  SceneTruth truth;
};

Recording simulate(double duration, const std::string& trajectory, double start, const std::string& kind) {
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.pinhole = {200.0, 200.0, 0.5 * (kWidth - 1), 0.5 * (kHeight - 1)};
  MotionOptions motion_options;
  motion_options.kind = "trajectory";
  motion_options.trajectory = trajectory;
  motion_options.start = start;
  const Motion motion = make_motion(motion_options, duration, 1, "", "motion");
  RenderedSceneOptions scene_options;
  scene_options.kind = kind;
  const auto scene = std::make_shared<const RenderedScene>(
      make_rendered_scene(scene_options, camera, motion, duration, Random(1), "", "scene"));
  EventSimulator simulator(std::make_unique<SceneBrightness>(camera, scene, motion, RenderingOptions{}, 2),
                           SimulatorOptions{}, duration, 1);
  Recording recording{{}, {camera, scene, motion}};
  for (std::vector<Event> events; simulator.read(events);) {
    recording.events.insert(recording.events.end(), events.begin(), events.end());
  }
  return recording;
}

/// Corners of the image of events, the best first.
std::vector<Vector2> corners(std::span<const Event> events) {
  cv::Mat image(kHeight, kWidth, CV_8U, cv::Scalar(0));
  for (const Event& event : events) {
    auto& pixel = image.at<std::uint8_t>(event.y, event.x);
    pixel = static_cast<std::uint8_t>(std::min(pixel + 40, 255));
  }
  cv::GaussianBlur(image, image, {5, 5}, 1.0);
  std::vector<cv::Point2f> found;
  cv::goodFeaturesToTrack(image, found, 2 * kTrackers, 0.01, 15.0);
  std::vector<Vector2> result;
  for (const cv::Point2f& corner : found) result.emplace_back(std::round(corner.x), std::round(corner.y));
  return result;
}

bool inside(const Vector2& p) {
  return p.x() >= kMargin && p.y() >= kMargin && p.x() + kMargin < kWidth && p.y() + kMargin < kHeight;
}

/// A tracker's seed and the event before which it was set.
struct Seed {
  Vector2 position;
  std::size_t event;
};

struct Tracking {
  std::vector<double> seconds;  ///< of each call of push
  std::int64_t in_range = 0;
  std::vector<Change> changes;
  std::map<std::int64_t, Seed> seeds;
};

Tracking track(std::span<const Event> all, const TrackerOptions& options, int threads) {
  Tracking result;
  TrackerSet set(kWidth, kHeight, threads);
  const auto end = [&](std::int64_t id) {
    result.in_range += set.tracker(id).event_count();
    set.remove(id);
  };
  for (std::size_t i = kImageEvents; i + kCall <= all.size(); i += kCall) {
    if (set.size() < kTrackers) {
      for (const Vector2& corner : corners(all.subspan(i - kImageEvents, kImageEvents))) {
        const auto ids = set.ids();
        const bool apart = std::ranges::none_of(
            ids, [&](std::int64_t id) { return (set.tracker(id).state().position - corner).norm() < 15.0; });
        if (set.size() < kTrackers && apart && inside(corner)) {
          result.seeds[set.add(Tracker(options, {0, corner, 0.0}))] = {corner, i};
        }
      }
    }
    const double start = now(threads);
    set.push(all.subspan(i, kCall), result.changes);
    result.seconds.push_back(now(threads) - start);
    const bool correlation = options.variant <= Variant::haste_correlation_star;
    for (const std::int64_t id : set.ids()) {
      const Tracker& tracker = set.tracker(id);
      const bool lost = correlation && tracker.running() && tracker.scores().spread() < 0.1;
      if (lost || !inside(tracker.state().position)) end(id);
    }
  }
  for (const std::int64_t id : set.ids()) end(id);
  return result;
}

/// [ns] an event in range, of the plain transcription.
double plain_cost(const std::vector<Event>& events, const TrackerOptions& options, const Tracking& tracking) {
  double seconds = 0.0;
  int count = 0;
  for (const auto& [id, seed] : tracking.seeds) {
    if (id % 10 != 0 || id > 50) continue;
    std::vector<Event> near;
    for (std::size_t i = seed.event; i < events.size() && near.size() < 4000; ++i) {
      const Vector2 offset = Vector2(events[i].x, events[i].y) - seed.position;
      if (offset.norm() < 20.0) near.push_back(events[i]);
    }
    testing::PlainTracker plain(options, {static_cast<int>(seed.position.x()), static_cast<int>(seed.position.y()), 0});
    const double start = now(1);
    for (const Event& event : near) count += plain.push(event) != Tracker::Update::out_of_range;
    seconds += now(1) - start;
  }
  return 1e9 * seconds / count;
}

struct Errors {
  std::vector<double> raw, middle, refined;
};

Errors errors(const Recording& recording, const Tracking& tracking) {
  Errors result;
  std::map<std::int64_t, std::pair<Vector3, double>> points;
  for (const Change& change : tracking.changes) {
    const double t = 1e-6 * static_cast<double>(change.after.t);
    const auto known = points.find(change.tracker);
    if (known == points.end()) {
      if (const auto point = recording.truth.point(change.after.position, t)) points[change.tracker] = {*point, t};
      continue;
    }
    const auto& [point, start] = known->second;
    const auto pixel = recording.truth.pixel(point, t);
    if (!pixel || t < start + 0.1 || t > start + 0.2) continue;
    result.raw.push_back((change.after.position - *pixel).norm());
    result.middle.push_back((midpoint(change) - *pixel).norm());
    result.refined.push_back((refined_position(change) - *pixel).norm());
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) try {
  const char* data = std::getenv("EVBENCH_DATA");
  const double seconds = argc > 1 ? std::atof(argv[1]) : 3.0;
  const std::string trajectory =
      argc > 2 ? argv[2] : std::string(data != nullptr ? data : ".") + "/haste_simulated/dynamic_plane/groundtruth.txt";
  const Recording recording =
      simulate(seconds, trajectory, argc > 3 ? std::atof(argv[3]) : 0.0, argc > 4 ? argv[4] : "plane");
  const int threads = argc > 6 ? std::atoi(argv[6]) : 1;
  fmt::print("{:.2f} million events in {} s\n\n", 1e-6 * static_cast<double>(recording.events.size()), seconds);
  fmt::print(
      "| variant | ns an event in range | plain [ns] | plain / this | in range, trackers an event | changes [%] | "
      "million "
      "events/s | error, new state [px] | midpoint | refined | 90 % midpoint | refined |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  const std::pair<const char*, Variant> variants[] = {{"correlation", Variant::correlation},
                                                      {"haste_correlation", Variant::haste_correlation},
                                                      {"haste_correlation_star", Variant::haste_correlation_star},
                                                      {"haste_difference", Variant::haste_difference},
                                                      {"haste_difference_star", Variant::haste_difference_star}};
  for (const auto& [name, variant] : variants) {
    if (const char* only = argc > 5 ? argv[5] : ""; std::string(name).find(only) == std::string::npos) continue;
    TrackerOptions options;
    options.variant = variant;
    const bool slow = variant == Variant::correlation || variant == Variant::haste_difference;
    const auto some = std::span(recording.events).first(slow ? recording.events.size() / 4 : recording.events.size());
    const auto count = static_cast<double>(some.size());
    Tracking tracking = track(some, options, threads);
    for (int i = 1; i < (slow ? 2 : kRuns); ++i) {
      const std::vector<double> again = track(some, options, threads).seconds;
      for (std::size_t call = 0; call < again.size(); ++call) {
        tracking.seconds[call] = std::min(tracking.seconds[call], again[call]);
      }
    }
    const double time = std::accumulate(tracking.seconds.begin(), tracking.seconds.end(), 0.0);
    const auto in_range = static_cast<double>(tracking.in_range);
    const double plain = plain_cost(recording.events, options, tracking);
    const Errors e = errors(recording, tracking);
    fmt::print(
        "| {} | {:.1f} | {:.0f} | {:.1f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n",
        name, 1e9 * time / in_range, plain, plain * in_range / (1e9 * time), in_range / count,
        100.0 * static_cast<double>(tracking.changes.size()) / in_range, 1e-6 * count / time, quantile_of(e.raw, 0.5),
        quantile_of(e.middle, 0.5), quantile_of(e.refined, 0.5), quantile_of(e.middle, 0.9),
        quantile_of(e.refined, 0.9));
    std::fflush(stdout);
  }
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "haste_micro: {}\n", error.what());
  return 1;
}
