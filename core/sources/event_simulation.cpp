#include "core/sources/event_simulation.hpp"

#include <fmt/format.h>

#include "core/io/path.hpp"
#include "core/plugin/registration.hpp"
#include "core/simulation/time_spans.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

const Registration<Source, EventSimulation> event_simulation_registration(
    "event_simulation", "simulated events of a rendered scene, with ground truth", 2);

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
  const auto features = [this] {
    return Scene(scene().features, camera(), [truth = truth()](const SE3& T_world_camera, const Vector3& point) {
      return truth.unoccluded(T_world_camera, point);
    });
  };
  make_tracks_of(features, options.tracks, context.place + ".tracks");
}

std::shared_ptr<const RenderedScene> EventSimulation::drawn_scene() const {
  std::call_once(drawn_, [this] {
    scene_ = std::make_shared<const RenderedScene>(
        make_rendered_scene(scene_options_, camera(), motion(), duration(), random(Part::scene), folder_, place_));
  });
  return scene_;
}

std::unique_ptr<EventReader> EventSimulation::all_events() const {
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
