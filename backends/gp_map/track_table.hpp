#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "backends/gp_map/smoother.hpp"
#include "core/plugin/exchange.hpp"
#include "core/smoother/factor_graph.hpp"
#include "core/structure/track_buffer.hpp"

namespace evbench::gp_map {

/// A landmark that was re-acquired after it had been out of view.
struct Reappearance {
  int landmark = 0;
  double t = 0.0;                   ///< [s] of the first observation since then
  Vector2 pixel = Vector2::Zero();  ///< of this observation, undistorted [px]
  double inverse_sigma = 1.0;       ///< of this observation [1/px]
};

/// Which tracks there are, and which landmark each of them shows. Nothing else knows tracks.
class TrackTable {
 public:
  enum class Role {
    waiting,   ///< until its landmark can be triangulated
    landmark,  ///< its observations are of a landmark
    drifted,   ///< they were, until it drifted
    outlier,
  };

  struct Track {
    Role role = Role::waiting;
    int landmark = -1;    ///< its index in the estimate
    int tried_with = 0;   ///< observations at the last failed triangulation
    bool misfit = false;  ///< that failed because no point fits them
    bool ended = false;
    bool mismatched = false;  ///< until it ends, it does not show its landmark
  };

  explicit TrackTable(double sigma_scale) : sigma_scale_(sigma_scale) {}

  // Observations.

  /// Keeps a batch until advance_to().
  void receive(const UndistortedBatch& batch);
  /// Takes the observations up to t and no later ones: the estimate at a time depends on data until then. `association`
  /// is called before an observation of a landmark's track counts; it may give the track another role.
  void advance_to(double t, const std::function<void(const UndistortedObservation&)>& association);
  /// New observations of landmarks, once.
  std::vector<std::pair<int, Observation>> take_observations() { return std::exchange(new_observations_, {}); }
  /// Observations of the waiting tracks.
  const TrackBuffer& waiting() const { return waiting_; }
  /// Drops waiting tracks that have ended: they had their last chance in the step after their end; before the initial
  /// map, in the step that makes it, unless that is `memory` [s] later.
  void drop_ended(double t, bool has_map, double memory);

  // Roles.

  const Track* find(TrackId id) const;
  Track& at(TrackId id) { return tracks_.at(id); }
  const std::map<TrackId, Track>& all() const { return tracks_; }
  /// Live tracks, and tracks that have ended since the last step.
  const std::set<TrackId>& live() const { return live_; }
  /// Live tracks that are landmarks. A track without recent observations has not moved.
  int landmarks_in_view() const;
  /// Live tracks that do not fit the map: the landmarks of a wrong map are rejected or leave the view, and most new
  /// tracks cannot be triangulated in it.
  int mismatched() const;

  /// A waiting track is a landmark from now on, which is the estimate's newest one.
  void become_landmark(TrackId id, int landmark);
  /// A landmark's track shows another landmark from now on, the estimate's newest one.
  void become_another(TrackId id, int landmark);
  /// A landmark's track waits again.
  void wait_again(TrackId id);
  /// Further observations of the landmark's track are not of this landmark.
  void end_track_of(int landmark, Role role);
  /// The track does not show its landmark until it ends.
  void mismatch(TrackId id);

  /// The track of a landmark, unless it shows another one by now.
  std::optional<TrackId> track_of(int landmark) const;
  int tracks_with_landmarks() const { return tracks_with_landmarks_; }

  // Re-acquired tracks, until it is known whether they show their landmarks.

  void reappear(TrackId id, const Reappearance& seen) { reappeared_.try_emplace(id, seen); }
  std::map<TrackId, Reappearance>& reappeared() { return reappeared_; }
  bool is_reappearing(int landmark) const { return reappeared_.contains(tracks_of_landmarks_[index(landmark)]); }

  // For the front-end.

  /// Tracks that were found to be outliers, once.
  std::vector<TrackId> take_outliers() { return std::exchange(outliers_, {}); }
  /// Tracks of landmarks that have ended since the last call.
  std::vector<TrackId> take_ended() { return std::exchange(ended_landmarks_, {}); }

  // While the map is tentative, the observations of all tracks are remembered.

  void remember() { remembered_ = waiting_; }
  void forget_remembered() { remembered_ = TrackBuffer(); }
  /// Tracks that are not landmarks wait again, with all their observations: they did not fit a wrong estimate. Tracks
  /// that are landmarks (`is_alive`) stay so.
  void recall(const std::function<bool(int landmark)>& is_alive);

 private:
  void take(const UndistortedObservation& z, const std::function<void(const UndistortedObservation&)>& association);

  double sigma_scale_;
  std::map<TrackId, Track> tracks_;
  std::vector<TrackId> tracks_of_landmarks_;  ///< by landmark; a re-acquired track may have several
  std::set<TrackId> live_;
  TrackBuffer waiting_, remembered_;
  std::vector<UndistortedObservation> pending_;  ///< later than the newest state
  std::vector<TrackEnd> ending_;                 ///< likewise
  std::vector<std::pair<int, Observation>> new_observations_;
  std::map<TrackId, Reappearance> reappeared_;
  std::vector<TrackId> outliers_, ended_landmarks_;
  int tracks_with_landmarks_ = 0;
};

}  // namespace evbench::gp_map
