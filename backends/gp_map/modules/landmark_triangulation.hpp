#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "backends/gp_map/estimate.hpp"
#include "backends/gp_map/track_table.hpp"
#include "core/plugin/options.hpp"
#include "core/structure/triangulation.hpp"

namespace evbench::gp_map {

struct MapOptions {
  TriangulationOptions triangulation;
  int min_observations = 5;
  double patience = 0.0;
  double depth_sigma = 0.5;
  double tentative = 5.0;

  void declare(OptionSet& set);
};

/// Makes landmarks of tracks: by triangulation from their observations or, without parallax, at the scene's depth. Such
/// a landmark determines rotation, and where tracks are short, nothing else carries the scale on. The guess counts
/// until the landmark shows parallax: those without parallax at first are farther away than most.
class LandmarkTriangulation {
 public:
  LandmarkTriangulation(const MapOptions& options, double sigma_scale) : options_(options), sigma_scale_(sigma_scale) {}

  /// Makes landmarks of the waiting tracks that allow it.
  void add(Estimate& estimate, TrackTable& tracks);
  /// Drops guessed depths that are not needed any more.
  void drop_guesses(Estimate& estimate);

 private:
  /// Where a track's landmark is, with the prior on it.
  struct Location {
    std::optional<std::pair<Vector3, LandmarkPrior>> place = {};  ///< none yet,
    bool misfit = false;                                          ///< or none because no point fits the observations
  };
  Location locate(const Estimate& estimate, std::span<const UndistortedObservation> observations) const;

  MapOptions options_;
  double sigma_scale_;
  std::vector<int> guessed_;  ///< landmarks with guessed depths
};

}  // namespace evbench::gp_map
