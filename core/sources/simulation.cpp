#include "core/sources/simulation.hpp"

#include <algorithm>

#include "core/support/path.hpp"

namespace evbench {
namespace {

const Registration<Source, Simulation> registration("simulation", "simulated feature tracks with ground truth");

}  // namespace

void Simulation::Options::declare(OptionSet& set) {
  set.add("duration", duration, "length of the sequence [s]").range(0.0, 36e3).above(0.0);
  set.add("seed", seed, "of all that is drawn; below 0: the run's seed");
  set.add("ground_truth_rate", ground_truth_rate, "poses of the ground truth [Hz]").range(0.0, 1e4).above(0.0);
  set.group("camera", camera, "the camera");
  set.group("motion", motion, "how the camera moves");
  set.group("scene", scene, "what it looks at");
  set.group("tracks", tracks, "how features are tracked");
}

Simulation::Simulation(const Options& options, const SourceContext& context)
    : duration_(options.duration), camera_(make_camera(options.camera, context.folder, context.place + ".camera")) {
  const std::uint64_t seed = options.seed < 0 ? context.seed : static_cast<std::uint64_t>(options.seed);
  // Each part draws from a stream of its own: other tracks do not change the motion.
  const std::uint64_t motion_seed = Random(seed, 1).next(), track_seed = Random(seed, 2).next();
  const Motion motion = make_motion(options.motion, duration_, motion_seed, context.folder, context.place + ".motion");
  Scene scene(options.scene, camera_, motion, duration_, Random(seed, 3));
  tracks_ = simulate_tracks(options.tracks, camera_, motion, scene, duration_, track_seed, context.place + ".tracks");
  ground_truth_ = sample_motion(motion, duration_, options.ground_truth_rate);
  if (!options.camera.calib.empty()) files_.push_back(resolve_path(options.camera.calib, context.folder));
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
