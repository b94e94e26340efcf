#include "core/sources/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/plugin/registration.hpp"

namespace evbench {
namespace {

const Registration<Source, Simulation> simulation_registration("simulation",
                                                               "simulated feature tracks with ground truth", 2);

}  // namespace

void Simulation::Options::declare(OptionSet& set) {
  SimulatedSequence::Options::declare(set);
  set.group("scene", scene, "scene in view of the camera");
}

Simulation::Simulation(const Options& options, const SourceContext& context) : SimulatedSequence(options, context) {
  const auto make_scene = [this, scene = options.scene] {
    return Scene(scene, camera(), motion(), duration(), random(Part::scene));
  };
  make_tracks_of(make_scene, options.tracks, context.place + ".tracks");
  tracks();  // reports now what can't be simulated
}

std::vector<std::string> Simulation::remarks() const {
  const auto count = [this](TrackKind kind) {
    return std::ranges::count(tracks().tracks, kind, &SimulatedTracks::Track::kind);
  };
  std::vector<std::string> result = motion_remarks();
  result.push_back(fmt::format("{} tracks simulated ({} outliers, {} drifting), {} observations, path {:.3f} m",
                               tracks().tracks.size(), count(TrackKind::outlier), count(TrackKind::drift),
                               tracks().observations.size(), ground_truth().path_length()));
  return result;
}

}  // namespace evbench
