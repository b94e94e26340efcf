#include "core/sources/simulation.hpp"

#include <algorithm>

#include "core/support/path.hpp"

namespace evbench {
namespace {

const Registration<Source, Simulation> registration("simulation", "simulated feature tracks with ground truth");

}  // namespace

void SimulatedCameraOptions::declare(OptionSet& set) {
  set.add("width", width, "sensor's width [px]").range(1, 1e5);
  set.add("height", height, "sensor's height [px]").range(1, 1e5);
  set.add("focal_length", focal_length, "focal length [px]").above(0.0);
  set.add("distortion", distortion, "lens model of the raw pixels")
      .choices({"none", "radial_tangential", "equidistant"});
  set.add("coefficients", coefficients, "of the lens: k1 k2 p1 p2 k3 (radial_tangential), k1 k2 k3 k4 (equidistant)");
}

Camera make_camera(const SimulatedCameraOptions& options, const std::string& place) {
  Camera camera;
  camera.width = options.width;
  camera.height = options.height;
  camera.pinhole = {options.focal_length, options.focal_length, 0.5 * (options.width - 1), 0.5 * (options.height - 1)};
  camera.distortion = parse_distortion_model(options.distortion);
  const std::size_t expected = camera.distortion == DistortionModel::none                ? 0
                               : camera.distortion == DistortionModel::radial_tangential ? 5
                                                                                         : 4;
  if (options.coefficients.size() != expected) {
    throw InputError(fmt::format("{}.coefficients: has {} numbers; {} expects {}", place, options.coefficients.size(),
                                 options.distortion, expected));
  }
  std::ranges::copy(options.coefficients, camera.coefficients.begin());
  for (const double x : {0.0, camera.width - 1.0}) {
    for (const double y : {0.0, camera.height - 1.0}) {
      if (camera.undistort({x, y})) continue;
      throw InputError(
          fmt::format("{}.coefficients: bend the rays so far that the corner ({}, {}) sees nothing; expected a lens "
                      "that is invertible over the image",
                      place, x, y));
    }
  }
  return camera;
}

void Simulation::Options::declare(OptionSet& set) {
  set.add("duration", duration, "length of the sequence [s]").range(0.0, 36e3).above(0.0);
  set.add("seed", seed, "of all that is drawn; below 0: the run's seed");
  set.add("ground_truth_rate", ground_truth_rate, "poses of the ground truth [Hz]").range(0.0, 1e4).above(0.0);
  set.group("camera", camera, "the camera; its principal point is the image's middle");
  set.group("motion", motion, "how the camera moves");
  set.group("scene", scene, "what it looks at");
  set.group("tracks", tracks, "how features are tracked");
}

Simulation::Simulation(const Options& options, const SourceContext& context)
    : duration_(options.duration), camera_(make_camera(options.camera, context.place + ".camera")) {
  const std::uint64_t seed = options.seed < 0 ? context.seed : static_cast<std::uint64_t>(options.seed);
  // Each part draws from a stream of its own: other tracks do not change the motion.
  const std::uint64_t motion_seed = Random(seed, 1).next(), track_seed = Random(seed, 2).next();
  const Motion motion = make_motion(options.motion, duration_, motion_seed, context.folder, context.place + ".motion");
  Scene scene(options.scene, camera_, motion, duration_, Random(seed, 3));
  tracks_ = simulate_tracks(options.tracks, camera_, motion, scene, duration_, track_seed, context.place + ".tracks");
  ground_truth_ = sample_motion(motion, duration_, options.ground_truth_rate);
  if (options.motion.kind == "trajectory") files_.push_back(resolve_path(options.motion.trajectory, context.folder));
}

std::vector<std::string> Simulation::remarks() const {
  const auto count = [this](TrackKind kind) {
    return std::ranges::count(tracks_.tracks, kind, &SimulatedTracks::Track::kind);
  };
  return {fmt::format("{} tracks simulated ({} outliers, {} drifting), {} observations, path {:.3f} m",
                      tracks_.tracks.size(), count(TrackKind::outlier), count(TrackKind::drift),
                      tracks_.observations.size(), ground_truth_.path_length())};
}

}  // namespace evbench
