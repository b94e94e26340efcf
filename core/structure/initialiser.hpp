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
  double window = 0.1;  ///< [s], of the line through a track's observations that gives its place at a time
  TwoViewOptions two_view;

  void declare(OptionSet& set);
};

/// An initial map and motion, up to scale.
struct InitialGuess {
  double t0 = 0.0, t1 = 0.0;        ///< [s]
  SE3 T1;                           ///< T_world_camera at t1; the world is the camera at t0
  std::vector<Landmark> landmarks;  ///< by track, world frame; their median depth from t0 is 1
  double median_parallax_deg = 0.0;
  std::vector<TrackId> outliers;  ///< tracks seen at both times that the guess doesn't explain
};

/// Where tracks were at the first view and are now.
struct TrackMatches {
  std::string reason;  ///< why there are none
  double t0 = 0.0, t1 = 0.0;
  std::vector<TrackId> tracks;
  std::vector<Vector2> first, second;  ///< [px]
  bool or_nearest = false;             ///< as of their PlaceWindow

  double median_motion() const;  ///< [px] from the first to the second place; of any but none
};

/// The places of the tracks that have one at both times [s]; window as of TrackBuffer::position.
TrackMatches matches_between(const TrackBuffer& buffer, double t0, double t1, const PlaceWindow& window);

/// Initialisation of monocular odometry from two views (Liu et al. 2022, Algorithm 1, lines 7-9).
///
/// The first view is at a reference time: the first with enough tracks; it moves on when too few of its tracks are
/// left, and with time while the camera stands still: views of a stand say nothing. Each attempt matches the tracks'
/// places then and now, those of slow ones, too, where there are too few others. A planar scene leaves two candidates,
/// and each comes with its depth reversal (depth_reversal.hpp): refine each over all observations between t0 and t1 and
/// keep the cheapest, or wait when two different ones cost about the same.
class Initialiser {
 public:
  Initialiser(const InitialiserOptions& options, const PinholeCamera& camera) : options_(options), camera_(camera) {}

  struct Attempt {
    std::string reason;                    ///< why there is no candidate yet
    std::vector<InitialGuess> candidates;  ///< best first
  };

  /// Tries with the tracks at time t; call it with times that increase.
  Attempt attempt(const TrackBuffer& tracks, double t);

  /// The same in two parts: the matches are cheap, what they are explained by is not.
  TrackMatches match(const TrackBuffer& tracks, double t);
  Attempt explain(const TrackMatches& matches) const;

  /// Time of the first view, once there is one.
  std::optional<double> reference_time() const { return reference_; }

 private:
  void pass_stand(const TrackBuffer& tracks, double t);
  bool are_enough(const TrackMatches& matches) const {
    return static_cast<int>(matches.tracks.size()) >= options_.min_tracks;
  }

  InitialiserOptions options_;
  PinholeCamera camera_;
  std::optional<double> reference_;
};

}  // namespace evbench
