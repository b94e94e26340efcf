#include "core/sources/event_simulation.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "core/events/native/keeping_reader.hpp"
#include "core/io/path.hpp"
#include "core/io/sha256.hpp"
#include "core/plugin/registration.hpp"
#include "core/plugin/write_options.hpp"
#include "core/simulation/time_spans.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"

namespace evbench {
namespace {

constexpr int kVersion = 3;

const Registration<Source, EventSimulation> event_simulation_registration(
    "event_simulation", "simulated events of a rendered scene, with ground truth", kVersion);

/// A pixel takes about 300 bytes.
constexpr std::int64_t kMostPixels = 4'000'000;

const SourceContext& check_sensor(const EventSimulation::Options& options, const SourceContext& context) {
  const auto& [width, height] = std::pair(options.camera.width, options.camera.height);
  if (std::int64_t{width} * height > kMostPixels) {
    throw InputError(
        fmt::format("{}.camera: {} x {} pixels; expected at most {} in all, of which events can be simulated",
                    context.place, width, height, kMostPixels));
  }
  return context;
}

}  // namespace

void EventSimulation::Options::declare(OptionSet& set) {
  SimulatedSequence::Options::declare(set);
  set.group("scene", scene, "scene in view of the camera");
  set.group("rendering", rendering, "how the scene becomes intensities");
  set.group("simulator", simulator, "how intensities become events");
  set.add("cache", cache, "path of a folder that keeps the events, so that they are simulated once; empty: none")
      .folder();
}

EventSimulation::EventSimulation(const Options& options, const SourceContext& context)
    : SimulatedSequence(options, check_sensor(options, context)),
      scene_options_(options.scene),
      folder_(context.folder),
      place_(context.place + ".scene"),
      rendering_(options.rendering),
      simulator_(options.simulator) {
  parse_time_spans(simulator_.outages, context.place + ".simulator.outages");  // reports errors now
  check_rendered_scene(scene_options_, camera(), motion(), duration(), place_);
  if (!scene_options_.picture.empty()) {
    add_file(resolve_path(scene_options_.picture, folder_));
    drawn_scene();  // reports an unreadable picture now
  }
  if (!options.cache.empty()) cache_ = cache_file(options);
  const auto features = [this] {
    return Scene(scene().features, camera(), [truth = truth()](const SE3& T_world_camera, const Vector3& point) {
      return truth.unoccluded(T_world_camera, point);
    });
  };
  make_tracks_of(features, options.tracks, context.place + ".tracks");
}

/// The file is named by all that determines its events.
std::string EventSimulation::cache_file(const Options& options) const {
  Json settings = write_options(options);
  for (const char* other : {"cache", "tracks", "ground_truth_rate"}) settings.erase(other);
  settings["version"] = kVersion;
  settings["stream"] = random(Part::sensor).next();
  for (const std::string& file : files()) settings["files"].push_back(sha256_file(file));
  const std::filesystem::path folder = resolve_path(options.cache, folder_);
  std::error_code error;
  std::filesystem::create_directories(folder, error);  // else the file can't be made, which says why
  return folder / fmt::format("events-{}.evb", sha256(dump_json(settings)).substr(0, 10));
}

std::shared_ptr<const RenderedScene> EventSimulation::drawn_scene() const {
  std::call_once(drawn_, [this] {
    scene_ = std::make_shared<const RenderedScene>(
        make_rendered_scene(scene_options_, camera(), motion(), duration(), random(Part::scene), folder_, place_));
  });
  return scene_;
}

std::unique_ptr<EventReader> EventSimulation::all_events() const {
  const auto simulate = [this] { return simulated_events(); };
  return cache_.empty() ? simulate() : read_or_keep(cache_, simulate);
}

std::unique_ptr<EventReader> EventSimulation::simulated_events() const {
  auto brightness =
      std::make_unique<SceneBrightness>(camera(), drawn_scene(), motion(), rendering_, simulator_.threads);
  return std::make_unique<EventSimulator>(std::move(brightness), simulator_, duration(), random(Part::sensor).next());
}

std::vector<std::string> EventSimulation::remarks() const {
  std::vector<std::string> result = motion_remarks();
  result.push_back(fmt::format("events simulated while they are read; path {:.3f} m", ground_truth().path_length()));
  return result;
}

}  // namespace evbench
