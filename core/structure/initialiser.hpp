#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/plugin/backend.hpp"
#include "core/structure/track_buffer.hpp"
#include "core/structure/two_view.hpp"

namespace evbench {

struct InitialiserOptions {
  int min_tracks = 15;  ///< seen at both times
  double window = 0.1;  ///< [s], length of the line fit that gives a track's position at a time
  TwoViewOptions two_view;

  void declare(OptionSet& set);
};

/// An initial map and motion, up to scale.
struct InitialGuess {
  double t0 = 0.0, t1 = 0.0;        ///< [s]
  SE3 T1;                           ///< T_world_camera at t1; the world is the camera at t0
  std::vector<Landmark> landmarks;  ///< by track, world frame; their median depth from t0 is 1
  double median_parallax_deg = 0.0;
  std::vector<TrackId> outliers;  ///< tracks seen at both times that do not fit the guess
};

/// Matched positions of tracks in the first view and now.
struct TrackMatches {
  std::string reason;  ///< why there are none
  double t0 = 0.0, t1 = 0.0;
  std::vector<TrackId> tracks;
  std::vector<Vector2> first, second;  ///< [px]
  bool or_nearest = false;             ///< or_nearest of their PlaceWindow

  double median_motion() const;  ///< [px] from first to second; needs at least one match
};

/// The tracks that have a position at both times [s]; `window` as in TrackBuffer::position().
TrackMatches matches_between(const TrackBuffer& buffer, double t0, double t1, const PlaceWindow& window);

/// Initialisation of monocular odometry from two views (Liu et al. 2022, Algorithm 1, lines 7-9).
///
/// The first view is at a reference time: the first time with enough tracks. It moves on when too few of its tracks are
/// left, and during a stationary period, which has no parallax. Each attempt matches the positions of the tracks in the
/// first view and now; if these are too few, slowly observed tracks are matched too. A planar scene leaves two
/// candidates, and each comes with its depth reversal (depth_reversal.hpp). Refine each over all observations between
/// t0 and t1 and keep the one with the lowest cost, or wait if two different ones cost about the same.
class Initialiser {
 public:
  Initialiser(const InitialiserOptions& options, const PinholeCamera& camera) : options_(options), camera_(camera) {}

  struct Attempt {
    std::string reason;                    ///< why there is no candidate
    std::vector<InitialGuess> candidates;  ///< best first
  };

  /// Attempts an initialisation with the tracks at time t; call it with increasing times.
  Attempt attempt(const TrackBuffer& tracks, double t);

  /// attempt() in two steps: match() is cheap, solve() is not.
  TrackMatches match(const TrackBuffer& tracks, double t);
  Attempt solve(const TrackMatches& matches) const;

  /// Time of the first view, once there is one.
  std::optional<double> reference_time() const { return reference_; }

 private:
  void skip_stationary_period(const TrackBuffer& tracks, double t);
  bool are_enough(const TrackMatches& matches) const {
    return static_cast<int>(matches.tracks.size()) >= options_.min_tracks;
  }

  InitialiserOptions options_;
  PinholeCamera camera_;
  std::optional<double> reference_;
};

}  // namespace evbench
