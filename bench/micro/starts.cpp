// Initialisation of gp_map: 20 simulated starts of each of ten kinds, 240 x 180 pixels, f = 200, one track in ten an
// outlier.
//
//   initial_map_starts [--first SEED] [--seeds N] [KIND...]
//
// One row a kind. "right" is a share of all starts: the estimated motion has the true direction to within 30 degrees,
// and half of the landmarks' depths are, up to scale, within 30 %; at the initial map, when the first pose is
// published, 2.5 s after the initial map, and in the final estimate of what has been seen by then. "initial map" and
// "first pose" are times from the first observation, median and 90 % quantile; "reaches back" is how much of the time
// to the map the trajectory covers. "attempt" is what a step costs before there is an initial map, "first" the step
// that finds it, with the engine's first update; wall time.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <string_view>
#include <vector>

#include "backends/gp_map/gp_map.hpp"
#include "core/plugin/track_player.hpp"
#include "core/plugin/undistort.hpp"
#include "core/simulation/track_simulator.hpp"
#include "core/support/index.hpp"
#include "core/support/median.hpp"
#include "eval/quantile.hpp"

namespace {

using namespace evbench;

constexpr double kDuration = 8.0;    ///< [s] for a start, at most
constexpr double kAfterwards = 2.5;  ///< [s] until a start is evaluated again
constexpr double kExchange = 0.01;   ///< [s]

struct Kind {
  std::string_view name;
  std::string_view scene;
  Vector3 velocity;  ///< [m/s], besides the smooth random motion
  double amplitude;  ///< [m] of that
  double rotation;   ///< [rad] likewise
  TrackOptions tracks;
};

TrackOptions usual_tracks() {
  TrackOptions tracks;
  tracks.outlier_share = 0.1;
  return tracks;
}

TrackOptions dense_tracks() {
  TrackOptions tracks;
  tracks.alive = 96;
  tracks.lifetime = {4.0, 4.0};
  tracks.rate = {180.0, 180.0};
  tracks.noise = 0.1;
  tracks.wander = 1.2;
  tracks.wander_time = 0.3;
  return tracks;
}

std::vector<Kind> all_kinds() {
  const TrackOptions usual = usual_tracks();
  return {
      {"hand-held, plane", "plane", Vector3::Zero(), 0.3, 0.15, usual},
      {"hand-held, boxes", "boxes", Vector3::Zero(), 0.3, 0.15, usual},
      {"hand-held, cloud", "frustum", Vector3::Zero(), 0.3, 0.15, usual},
      {"forward, plane", "plane", {0.0, 0.0, 0.4}, 0.03, 0.08, usual},
      {"forward, cloud", "frustum", {0.0, 0.0, 0.4}, 0.03, 0.08, usual},
      {"sideways, plane", "plane", {0.3, 0.0, 0.0}, 0.03, 0.08, usual},
      {"sideways, boxes", "boxes", {0.3, 0.0, 0.0}, 0.03, 0.08, usual},
      {"turning, plane", "plane", Vector3::Zero(), 0.1, 0.25, usual},
      {"turning, cloud", "frustum", Vector3::Zero(), 0.1, 0.25, usual},
      {"dense, slow", "frustum", {0.1, 0.0, 0.0}, 0.01, 0.03, dense_tracks()},
  };
}

/// What a kind's camera sees, and the truth.
struct Beginning {
  Camera camera;
  Motion motion;
  SimulatedTracks tracks;
};

Beginning simulate(const Kind& kind, std::uint64_t seed) {
  Beginning result;
  result.camera.width = 240;
  result.camera.height = 180;
  result.camera.pinhole = {200.0, 200.0, 119.5, 89.5};
  MotionOptions motion;
  motion.kind = "smooth_random";
  motion.amplitude = kind.amplitude;
  motion.rotation_amplitude = kind.rotation;
  const Motion base = make_motion(motion, kDuration, seed, ".", "motion");
  result.motion = [base, velocity = kind.velocity](double t) {
    SE3 T = base(t);
    T.p += t * velocity;
    return T;
  };
  SceneOptions scene_options;
  scene_options.kind = kind.scene;
  Scene scene(scene_options, result.camera, result.motion, kDuration, Random(seed, 1));
  result.tracks = simulate_tracks(kind.tracks, result.camera, result.motion, scene, kDuration, seed, "tracks");
  return result;
}

double angle_deg(const Vector3& a, const Vector3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegrees; }

/// Whether the estimated motion has the true direction, and landmarks have their true depths up to scale.
bool is_right(const gp_map::GpMap& backend, const Beginning& beginning) {
  const PoseTrajectory estimate = backend.trajectory();
  const StampedPose& first = estimate.poses().front();
  const SE3 T_first = first.T.inverse(), true_first = beginning.motion(first.t).inverse();
  Vector3 way = Vector3::Zero(), true_way = Vector3::Zero();
  for (const StampedPose& pose : estimate.poses()) {
    const Vector3 there = true_first * beginning.motion(pose.t).p;
    if (there.norm() <= true_way.norm()) continue;
    true_way = there;
    way = T_first * pose.T.p;
  }
  std::vector<double> ratios;
  for (const Landmark& landmark : backend.map()) {
    const auto& track = beginning.tracks.tracks[index(landmark.track)];
    if (track.kind != TrackKind::inlier) continue;
    ratios.push_back((T_first * landmark.position).z() / (true_first * track.point).z());
  }
  if (ratios.empty() || angle_deg(way, true_way) > 30.0) return false;
  const double scale = median(ratios);
  std::vector<double> errors;
  for (const double ratio : ratios) errors.push_back(std::abs(ratio / scale - 1.0));
  return median(errors) < 0.3;
}

struct Start {
  bool right = false, right_published = false, right_later = false, right_final = false;
  double seconds = kDuration;    ///< until the initial map
  double published = kDuration;  ///< [s] until the first pose is published
  double reach = 0.0;            ///< share of that time that the trajectory covers
  std::vector<double> attempts;  ///< [ms]
  double first = 0.0;            ///< [ms]
};

Start start(const Beginning& beginning, std::uint64_t seed) {
  BackEndContext context;
  context.camera = beginning.camera.pinhole;
  context.seed = seed;
  bool publishing = false;
  context.publish = [&](const CausalPose&) { publishing = true; };
  gp_map::GpMap backend({}, context);
  TrackPlayer player(beginning.tracks.observations);
  TrackBatch batch;
  Start result;
  const double begin = beginning.tracks.observations.front().t;
  bool found = false;
  for (double t = kExchange; t < kDuration; t += kExchange) {
    player.advance({t}, batch);
    backend.advance(undistort(batch, beginning.camera));
    if (!found && !backend.trajectory().empty()) {
      found = true;
      result.seconds = backend.trajectory().end() - begin;
      result.reach = (backend.trajectory().end() - backend.trajectory().start()) / result.seconds;
      result.right = is_right(backend, beginning);
    }
    if (publishing && result.published == kDuration) {
      result.published = t - begin;
      result.right_published = is_right(backend, beginning);
    }
    if (found && t > begin + result.seconds + kAfterwards) break;
  }
  if (found) {
    result.right_later = is_right(backend, beginning);
    backend.finish();
    result.right_final = is_right(backend, beginning);
  }
  for (const UpdateRecord& update : backend.updates()) {
    if (update.states == 0) {
      result.attempts.push_back(1e3 * update.seconds);
    } else {
      result.first = 1e3 * update.seconds;
      break;
    }
  }
  return result;
}

void report(std::string_view name, const std::vector<Start>& starts) {
  const auto share = [&](auto member) {
    return 100.0 * static_cast<double>(std::ranges::count(starts, true, member)) / static_cast<double>(starts.size());
  };
  const auto all = [&](auto member) {
    std::vector<double> values;
    for (const Start& start : starts) values.push_back(start.*member);
    return values;
  };
  std::vector<double> attempts{0.0};
  for (const Start& start : starts) attempts.insert(attempts.end(), start.attempts.begin(), start.attempts.end());
  fmt::print(
      "| {:<16} | {:5.1f} | {:5.1f} | {:5.1f} | {:5.1f} | {:5.2f} | {:5.2f} | {:5.2f} | {:5.2f} | {:5.1f} | {:6.2f} | "
      "{:6.1f} | {:6.1f} | {:6.1f} |\n",
      name, share(&Start::right), share(&Start::right_published), share(&Start::right_later),
      share(&Start::right_final), quantile_of(all(&Start::seconds), 0.5), quantile_of(all(&Start::seconds), 0.9),
      quantile_of(all(&Start::published), 0.5), quantile_of(all(&Start::published), 0.9),
      100.0 * quantile_of(all(&Start::reach), 0.5), quantile_of(attempts, 0.5), quantile_of(attempts, 1.0),
      quantile_of(all(&Start::first), 0.5), quantile_of(all(&Start::first), 1.0));
  std::fflush(stdout);
}

/// Takes "NAME NUMBER" off the beginning of the arguments, if it is there. False where the number isn't one from 1 on.
bool take_number(std::vector<std::string_view>& arguments, std::string_view name, int& number) {
  if (arguments.empty() || arguments.front() != name) return true;
  if (arguments.size() < 2) return false;
  const std::string_view text = arguments[1];
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  arguments.erase(arguments.begin(), arguments.begin() + 2);
  return read.ec == std::errc() && read.ptr == text.data() + text.size() && number >= 1;
}

int usage() {
  fmt::print(stderr, "usage: initial_map_starts [--first SEED] [--seeds N] [KIND...]; kinds:\n");
  for (const Kind& kind : all_kinds()) fmt::print(stderr, "  \"{}\"\n", kind.name);
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string_view> names(argv + 1, argv + argc);
  int first = 1, seeds = 20;
  if (!take_number(names, "--first", first) || !take_number(names, "--seeds", seeds)) return usage();
  std::vector<Kind> kinds = all_kinds();
  for (const auto name : names) {
    if (std::ranges::find(kinds, name, &Kind::name) == kinds.end()) return usage();
  }
  fmt::print(
      "| kind | right [%] | published [%] | later [%] | final [%] | initial map [s] | 90 % [s] | first pose [s] | "
      "90 % [s] | reaches back [%] | attempt, median [ms] | max | first, median [ms] | max |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  std::vector<Start> all;
  for (const Kind& kind : kinds) {
    if (!names.empty() && std::ranges::find(names, kind.name) == names.end()) continue;
    std::vector<Start> starts;
    for (int seed = first; seed < first + seeds; ++seed) {
      const auto number = static_cast<std::uint64_t>(seed);
      starts.push_back(start(simulate(kind, number), number));
    }
    report(kind.name, starts);
    all.insert(all.end(), starts.begin(), starts.end());
  }
  report("all", all);
}
