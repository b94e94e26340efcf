#include "bench/battery/track_source.hpp"

#include <cmath>

#include "core/simulation/motion.hpp"
#include "core/simulation/scene.hpp"
#include "core/support/json.hpp"

namespace evbench::battery {
namespace {

template <class Options>
Options parsed(const std::string& json, const std::string& place) {
  return read_options<Options>(parse_json(json), place);
}

}  // namespace

TrackSource::TrackSource(const SequenceOptions& options)
    : range_(options.range > 0.0 ? options.range : options.duration) {
  camera_.width = 240;
  camera_.height = 180;
  camera_.pinhole = {200.0, 200.0, 119.5, 89.5};
  const Motion motion =
      make_motion(parsed<MotionOptions>(options.motion, "motion"), options.duration, 1, ".", "motion");
  SceneOptions scene_options;
  scene_options.kind = "volume";
  Scene scene(scene_options, camera_, motion, options.duration, Random(1));
  observations_ = simulate_tracks(parsed<TrackOptions>(options.tracks, "tracks"), camera_, motion, scene,
                                  options.duration, 1, "tracks")
                      .observations;
  std::erase_if(observations_, [&](TrackObservation& z) { return !options.keep(z); });
  ground_truth_ = sample_motion(motion, options.duration, 200.0);
}

bool TrackFrontEnd::advance(const Horizon& horizon, TrackBatch& batch) {
  const bool more = player_.advance(horizon, batch);
  if (received_.empty() || !received_.back().newest) return more;
  // Small enough to do no harm; it makes feedback at another time visible in the tracks.
  const double shift = 1e-3 * std::sin(1e3 * received_.back().newest->T.p.sum() + 1e4 * received_.back().t);
  for (TrackObservation& z : batch.observations) z.pixel.x() += shift;
  return more;
}

void TrackFrontEnd::receive(const Feedback& feedback) { received_.push_back(feedback); }

}  // namespace evbench::battery
