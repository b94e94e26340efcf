#include <algorithm>
#include <cmath>
#include <filesystem>

#include "bench/battery/battery.hpp"

namespace evbench::battery {
namespace {

using MakeSource = std::function<std::unique_ptr<Source>()>;

constexpr std::size_t kEvents = 1'000'000;  ///< checked, at most

std::vector<Event> events_of(const Source& source) {
  std::vector<Event> all;
  const auto stream = source.events();
  if (!stream) return all;
  for (std::vector<Event> events; all.size() < kEvents && stream->read(events);) {
    all.insert(all.end(), events.begin(), events.end());
  }
  return all;
}

std::vector<TrackObservation> tracks_of(const Source& source) {
  const auto tracks = source.true_tracks();
  return tracks ? std::vector(tracks->begin(), tracks->end()) : std::vector<TrackObservation>{};
}

void says_how_long_it_is(const MakeSource& make) {
  const auto source = make();
  const auto [from, to] = source->time_range();
  require(std::isfinite(from) && std::isfinite(to) && from < to, "its time range is {} to {} s; expected from < to",
          from, to);
}

void has_a_camera(const MakeSource& make) {
  const Camera camera = make()->camera();
  require(camera.width > 0 && camera.height > 0, "its sensor has {} x {} pixels", camera.width, camera.height);
  require(camera.pinhole.fx > 0.0 && camera.pinhole.fy > 0.0, "its focal lengths are {} and {} px", camera.pinhole.fx,
          camera.pinhole.fy);
  require(camera.undistort({camera.width / 2.0, camera.height / 2.0}).has_value(),
          "its lens model can't be inverted in the middle of the image");
}

void has_valid_ground_truth(const MakeSource& make) {
  const auto source = make();
  const PoseTrajectory& truth = source->ground_truth();
  if (truth.empty()) return;
  const auto [from, to] = source->time_range();
  require(truth.start() < to && truth.end() > from, "its ground truth, {} to {} s, does not meet its range, {} to {} s",
          truth.start(), truth.end(), from, to);
  for (const auto& [t, T] : truth.poses()) {
    require(T.p.allFinite() && std::abs(T.q.norm() - 1.0) < 1e-6, "its true pose at {} s is not a pose", t);
  }
}

void has_tracks_in_order(const MakeSource& make) {
  const auto source = make();
  const auto [from, to] = source->time_range();
  double before = from;
  for (const TrackObservation& z : tracks_of(*source)) {
    require(z.t >= before, "its track observation at {} s comes after {} s", z.t, before);
    require(z.t <= to, "its track observation at {} s is after its end at {} s", z.t, to);
    require(z.pixel.allFinite() && z.noise.is_valid(), "its observation of track {} at {} s is not finite", z.track,
            z.t);
    before = z.t;
  }
}

void has_events_in_order(const MakeSource& make) {
  const auto source = make();
  const auto [from, to] = source->time_range();
  const Camera& camera = source->camera();
  auto before = static_cast<std::int64_t>(std::floor(1e6 * from));
  for (const Event& event : events_of(*source)) {
    require(event.t >= before, "its event at {} us comes after {} us", event.t, before);
    require(static_cast<double>(event.t) <= 1e6 * to + 1.0, "its event at {} us is after its end at {} s", event.t, to);
    require(event.x < camera.width && event.y < camera.height, "its event at pixel ({}, {}) is outside the sensor",
            event.x, event.y);
    before = event.t;
  }
}

void repeats_itself(const MakeSource& make) {
  const auto a = make(), b = make();
  const auto equal_observations = [](const TrackObservation& x, const TrackObservation& y) {
    return x.track == y.track && x.t == y.t && x.pixel == y.pixel && x.noise == y.noise;
  };
  require(std::ranges::equal(tracks_of(*a), tracks_of(*b), equal_observations), "made twice, its tracks differ");
  require(events_of(*a) == events_of(*b), "made twice, its events differ");
  require(std::ranges::equal(a->ground_truth().poses(), b->ground_truth().poses(),
                             [](const StampedPose& x, const StampedPose& y) { return x.t == y.t && x.T.p == y.T.p; }),
          "made twice, its ground truth differs");
}

void names_its_files(const MakeSource& make) {
  const auto source = make();
  for (const auto& files : {source->files(), source->event_files()}) {
    for (const std::string& file : files) {
      require(std::filesystem::is_regular_file(file), "it names the file {}, which does not exist", file);
    }
  }
}

}  // namespace

std::vector<Check> source_checks(const Plugins& plugins, const std::string& name, const Json& options,
                                 const std::string& folder) {
  const auto& entry = plugins.of<Source>().find(name, "battery");
  const Json resolved = entry.resolve(options, name, folder);
  const MakeSource make = [&entry, resolved, folder, name] { return entry.make(resolved, {1, folder, name}); };
  const auto check = [&](const char* text, void (*run)(const MakeSource&)) { return Check{text, [=] { run(make); }}; };
  return {
      check("says how long it is", says_how_long_it_is),
      check("has a camera", has_a_camera),
      check("has valid ground truth, or none", has_valid_ground_truth),
      check("has tracks in time order, or none", has_tracks_in_order),
      check("has events in time order, within the sensor, or none", has_events_in_order),
      check("has the same data when it is made twice", repeats_itself),
      check("names files that exist", names_its_files),
  };
}

}  // namespace evbench::battery
