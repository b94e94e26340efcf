#include "core/sources/simulated_sequence.hpp"

#include <utility>

#include "core/io/path.hpp"

namespace evbench {

void SimulatedSequence::Options::declare(OptionSet& set) {
  set.add("duration", duration, "length of the sequence [s]").range(0.0, 36e3).above(0.0);
  set.add("seed", seed, "of all that is drawn; below 0: the run's seed");
  set.add("ground_truth_rate", ground_truth_rate, "poses of the ground truth [Hz]").range(0.0, 1e4).above(0.0);
  set.group("camera", camera, "the camera");
  set.group("motion", motion, "how the camera moves");
  set.group("tracks", tracks, "tracks of the scene's features, their association known");
}

SimulatedSequence::SimulatedSequence(const Options& options, const SourceContext& context)
    : duration_(options.duration),
      seed_(options.seed < 0 ? context.seed : static_cast<std::uint64_t>(options.seed)),
      camera_(make_camera(options.camera, context.folder, context.place + ".camera")),
      motion_(make_motion(options.motion, duration_, random(Part::motion).next(), context.folder,
                          context.place + ".motion", &motion_remarks_)),
      ground_truth_(sample_motion(motion_, duration_, options.ground_truth_rate)) {
  if (!options.camera.calib.empty()) add_file(resolve_path(options.camera.calib, context.folder));
  if (options.motion.kind == "trajectory") add_file(resolve_path(options.motion.trajectory, context.folder));
}

void SimulatedSequence::make_tracks_of(std::function<Scene()> scene, const TrackOptions& options,
                                       const std::string& place) {
  options.check(camera_, place);
  make_tracks_ = [this, scene = std::move(scene), options, place] {
    Scene seen = scene();
    return simulate_tracks(options, camera_, motion_, seen, duration_, random(Part::tracks).next(), place);
  };
}

const SimulatedTracks& SimulatedSequence::tracks() const {
  std::call_once(made_, [this] { tracks_ = make_tracks_(); });
  return tracks_;
}

}  // namespace evbench
