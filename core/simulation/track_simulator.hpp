#pragma once

#include <vector>

#include "core/data/track.hpp"
#include "core/simulation/scene.hpp"

namespace evbench {

struct TrackOptions {
  int alive = 60;
  std::vector<double> lifetime = {0.5, 2.0};
  std::vector<double> rate = {50.0, 100.0};
  double noise = 0.7;
  double wander = 0.0, wander_time = 0.3;
  double quantisation = 0.0;
  double outlier_share = 0.0, outlier_speed = 40.0;
  double drift_share = 0.0, drift_speed = 5.0;
  double dropout_rate = 0.0;
  std::vector<double> dropout_length = {0.05, 0.2};
  double border = 4.0;
  std::vector<double> blackouts;

  void declare(OptionSet& set);

  /// Throws InputError for options that contradict each other or the camera.
  void check(const Camera& camera, const std::string& place) const;
};

enum class TrackKind {
  inlier,   ///< follows a point of the scene
  outlier,  ///< moves over the image independently of the scene
  drift,    ///< begins on a point and drifts off slowly
};

struct SimulatedTracks {
  std::vector<TrackObservation> observations;  ///< raw pixels; by time, then by track
  struct Track {
    TrackKind kind = TrackKind::inlier;
    Vector3 point = Vector3::Zero();  ///< world frame: where it began
  };
  std::vector<Track> tracks;  ///< by id: ids are 0, 1, 2, ... in the order in which tracks begin
};

/// Simulates the output of an asynchronous feature tracker. At any time there are about `alive` tracks, each updated at
/// its own irregular times (gaps of 0.4 to 1.6 mean gaps), with noise and quantisation, until its lifetime is over or
/// it leaves the image; then another begins elsewhere, with an id of its own (a dot that is seen again is a new track).
/// Times are whole microseconds, as those of events are. `sigma` of an observation is √(noise² + quantisation²/12), at
/// least 0.1 px, and with `wander` the root of the sum of both squares (track_wander.hpp). The same arguments give the
/// same bytes. Throws InputError, naming `place`, for options that contradict one another and if the camera sees no
/// point of the scene at any time.
SimulatedTracks simulate_tracks(const TrackOptions& options, const Camera& camera, const Motion& motion, Scene& scene,
                                double duration, std::uint64_t seed, const std::string& place);

}  // namespace evbench
