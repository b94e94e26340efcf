#include "core/sources/event_simulation.hpp"

#include "core/support/path.hpp"

namespace evbench {
namespace {

const Registration<Source, EventSimulation> registration("event_simulation",
                                                         "simulated events of a rendered scene, with ground truth");

}  // namespace

void EventSimulation::Options::declare(OptionSet& set) {
  set.add("duration", duration, "length of the recording [s]").range(0.0, 36e3).above(0.0);
  set.add("seed", seed, "of all that is drawn; below 0: the run's seed");
  set.add("ground_truth_rate", ground_truth_rate, "poses of the ground truth [Hz]").range(0.0, 1e4).above(0.0);
  set.group("camera", camera, "the camera");
  set.group("motion", motion, "how the camera moves");
  set.group("scene", scene, "what it looks at");
  set.group("rendering", rendering, "how the scene becomes intensities");
  set.group("simulator", simulator, "how intensities become events");
  set.group("tracks", tracks, "true tracks of the scene's features");
}

EventSimulation::EventSimulation(const Options& options, const SourceContext& context)
    : options_(options), camera_(make_camera(options.camera, context.folder, context.place + ".camera")) {
  const std::uint64_t seed = options.seed < 0 ? context.seed : static_cast<std::uint64_t>(options.seed);
  // Each part draws from a stream of its own: other tracks do not change the motion.
  const std::uint64_t motion_seed = Random(seed, 1).next(), track_seed = Random(seed, 2).next();
  sensor_seed_ = Random(seed, 4).next();
  motion_ = make_motion(options.motion, options.duration, motion_seed, context.folder, context.place + ".motion");
  scene_ = std::make_shared<const RenderedScene>(make_rendered_scene(
      options.scene, camera_, motion_, options.duration, Random(seed, 3), context.folder, context.place + ".scene"));
  Scene dots(scene_->features, camera_, [truth = truth()](const SE3& T_world_camera, const Vector3& point) {
    return truth.unoccluded(T_world_camera, point);
  });
  tracks_ =
      simulate_tracks(options.tracks, camera_, motion_, dots, options.duration, track_seed, context.place + ".tracks");
  ground_truth_ = sample_motion(motion_, options.duration, options.ground_truth_rate);
  for (const auto& [used, path] : {std::pair(!options.camera.calib.empty(), options.camera.calib),
                                   std::pair(options.motion.kind == "trajectory", options.motion.trajectory),
                                   std::pair(!options.scene.picture.empty(), options.scene.picture)}) {
    if (used) files_.push_back(resolve_path(path, context.folder));
  }
}

std::unique_ptr<EventReader> EventSimulation::events() const {
  auto brightness =
      std::make_unique<SceneBrightness>(camera_, scene_, motion_, options_.rendering, options_.simulator.threads);
  return std::make_unique<EventSimulator>(std::move(brightness), options_.simulator, options_.duration, sensor_seed_);
}

std::vector<std::string> EventSimulation::remarks() const {
  return {fmt::format("events simulated while they are read; {} surfaces, {} features, {} tracks, path {:.3f} m",
                      scene_->surfaces.size(), scene_->features.size(), tracks_.tracks.size(),
                      ground_truth_.path_length())};
}

}  // namespace evbench
