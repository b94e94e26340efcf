// Accuracy of tracks of real events where the camera's motion is known: a front-end without a back-end on
// the Event-Camera Dataset's excerpts in EVBENCH_DATA.
//
//   track_excerpts [--front-end NAME] [--set frontend.KEY=VALUE]...
//
// slider_depth: the camera moves along its x axis, so that nothing moves across, along y. A track slips when it is more
// than 1.2 px across from where it began; at 0.125 s of age, as a share of those still alive, and at any moment up to
// then, as a share of all that began. shapes_rotation and dynamic_rotation: the camera turns, by the IMU's mean rates
// (motion.txt), which are 12 to 16 % lower than what the events say, or by what the contrast of the events is highest
// for; a track errs by its distance, at its last observation, from where its first one would then be seen.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/experiment.hpp"
#include "core/events/event_stream.hpp"
#include "core/geometry/so3.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/error.hpp"
#include "core/support/median.hpp"
#include "frontends/str/registration/event_cloud.hpp"
#include "frontends/str/registration/testing/contrast.hpp"

namespace {

using namespace evbench;

constexpr int kWidth = 240, kHeight = 180;
constexpr double kSlip = 1.2;   ///< [px]
constexpr double kAge = 0.125;  ///< [s]

/// What is tried.
struct Choice {
  std::string frontend = "haste";
  std::vector<std::string> overrides = {};
};

struct Observed {
  double t;       ///< [s]
  Vector2 pixel;  ///< undistorted
};

struct Track {
  std::vector<Observed> observed;
  std::optional<double> ended;  ///< [s] when its end was published
};

/// An excerpt, and the front-end's tracks of it.
struct Excerpt {
  std::unique_ptr<Source> source;
  std::vector<Event> events;
  std::map<TrackId, Track> tracks;  ///< that are seen twice or more
};

constexpr double seconds(std::int64_t microseconds) { return 1e-6 * static_cast<double>(microseconds); }

Excerpt track(const std::string& folder, const std::string& file, const Choice& choice) {
  Excerpt result;
  StreamOptions options;
  options.read.width = kWidth;
  options.read.height = kHeight;
  EventStream stream(folder + "/" + file, options);
  for (std::vector<Event> chunk; stream.read(chunk);) {
    result.events.insert(result.events.end(), chunk.begin(), chunk.end());
  }
  Plugins plugins;
  add_registered_plugins(plugins, kBuiltIn);
  const Json config{{"source",
                     {{"type", "recording"},
                      {"events", folder + "/" + file},
                      {"calibration", folder + "/calib.txt"},
                      {"width", kWidth},
                      {"height", kHeight},
                      {"time_range", {seconds(result.events.front().t), seconds(result.events.back().t + 1)}}}},
                    {"frontend", {{"type", choice.frontend}}},
                    {"backend", {{"type", "gp_map"}}}};
  const Job job = ConfigFile(folder, config, plugins).experiment(choice.overrides).runs.front().job;
  result.source = make_source(job, plugins);
  const auto frontend = plugins.of<FrontEnd>()
                            .find(job.frontend.type, job.frontend.place)
                            .make(job.frontend.options, {*result.source, job.seed, job.folder, job.frontend.place});
  TrackBatch batch;
  for (bool more = true; more;) {
    more = frontend->advance({result.source->time_range().to}, batch);
    for (const TrackObservation& z : batch.observations) {
      const auto pixel = result.source->camera().undistort(z.pixel);
      if (pixel) result.tracks[z.track].observed.push_back({z.t, *pixel});
    }
    for (const TrackEnd& end : batch.ended) {
      const auto found = result.tracks.find(end.track);
      if (found != result.tracks.end()) found->second.ended = end.t;
    }
  }
  std::erase_if(result.tracks, [](const auto& entry) { return entry.second.observed.size() < 2; });
  return result;
}

void slider(const std::string& folder, const Choice& choice) {
  const Excerpt excerpt = track(folder + "/slider_depth", "events_chunk.txt", choice);
  std::size_t begun = 0, strayed = 0, alive = 0, slipped = 0;
  std::vector<double> errors;
  for (const auto& [id, track] : excerpt.tracks) {
    const Observed& first = track.observed.front();
    if (first.t + kAge > excerpt.source->time_range().to) continue;
    double at_age = 0.0, furthest = 0.0;
    for (const Observed& z : track.observed) {
      if (z.t > first.t + kAge) break;
      at_age = std::abs(z.pixel.y() - first.pixel.y());
      furthest = std::max(furthest, at_age);
    }
    ++begun;
    strayed += furthest > kSlip ? 1 : 0;
    if (track.ended && *track.ended < first.t + kAge) continue;
    ++alive;
    slipped += at_age > kSlip ? 1 : 0;
    errors.push_back(at_age);
  }
  const auto percent = [](std::size_t part, std::size_t whole) { return 100.0 * double(part) / double(whole); };
  if (begun == 0 || alive == 0) throw InputError("slider_depth: no track lives that long");
  fmt::print(
      "slider_depth: {} tracks; at {} s {} are alive, of which {} ({:.0f} %) are off by more than {} px across the "
      "motion, median {:.2f} px; at any moment up to then {} ({:.0f} %) of all\n",
      begun, kAge, alive, slipped, percent(slipped, alive), kSlip, median(errors), strayed, percent(strayed, begun));
}

Vector3 read_rates(const std::string& path) {
  std::ifstream file(path);
  Vector3 rates;
  if (!(file >> rates[0] >> rates[1] >> rates[2]))
    throw InputError(path + ": expected three angular velocities [rad/s]");
  return rates;
}

/// The rates for which the contrast of the excerpt's events is highest [rad/s].
Vector3 sharpest_rates(const Excerpt& excerpt, const Vector3& start) {
  const str::RayTable rays(excerpt.source->camera());
  str::EventCloud cloud;
  make_cloud(excerpt.events, rays, (excerpt.events.front().t + excerpt.events.back().t) / 2, cloud);
  return str::testing::maximise_contrast(cloud, str::MotionModel::rotation, start, 0.1 * start.norm(),
                                         rays.focal_length());
}

/// Distance of each track's last observation from where its first one would then be seen [px].
std::vector<double> errors_at_end(const Excerpt& excerpt, const Vector3& rates) {
  const auto& pinhole = excerpt.source->camera().pinhole;
  std::vector<double> result;
  for (const auto& [id, track] : excerpt.tracks) {
    const Observed &first = track.observed.front(), &last = track.observed.back();
    const Vector3 ray = so3::exp(-(last.t - first.t) * rates) * pinhole.ray(first.pixel);
    result.push_back((pinhole.project(ray) - last.pixel).norm());
  }
  return result;
}

void rotation(const std::string& folder, const std::string& name, const Choice& choice) {
  const Excerpt excerpt = track(folder + "/" + name, "events_excerpt.txt", choice);
  const Vector3 rates = read_rates(folder + "/" + name + "/motion.txt");
  const auto by_imu = errors_at_end(excerpt, rates);
  if (by_imu.empty()) throw InputError(name + ": no tracks");
  fmt::print(
      "{}: {} tracks, median error at the end {:.2f} px by the IMU's rates, {:.2f} px by those of highest contrast\n",
      name, by_imu.size(), median(by_imu), median(errors_at_end(excerpt, sharpest_rates(excerpt, rates))));
}

}  // namespace

int main(int argc, char** argv) {
  Choice choice;
  CLI::App app{"How good tracks of real events are"};
  app.add_option("--front-end", choice.frontend, "by default haste");
  app.add_option("--set", choice.overrides, "frontend.KEY=VALUE")->allow_extra_args(false);
  CLI11_PARSE(app, argc, argv);
  try {
    const char* const data = std::getenv("EVBENCH_DATA");
    if (data == nullptr) throw InputError("EVBENCH_DATA: is not set; expected the folder of real data");
    slider(data, choice);
    rotation(data, "shapes_rotation", choice);
    choice.overrides.insert(choice.overrides.begin(), "frontend.detection.interval=0.005");  // of 21 ms
    rotation(data, "dynamic_rotation", choice);
  } catch (const std::exception& error) {
    fmt::print(stderr, "track_excerpts: {}\n", error.what());
    return 1;
  }
  return 0;
}
