#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "frontends/haste/guidance.hpp"
#include "frontends/haste/options.hpp"
#include "frontends/haste/recent_events.hpp"
#include "frontends/haste/tracking/template.hpp"

namespace evbench::haste {

/// Re-acquires landmarks whose trackers have ended. Searches where the back-end expects them, by the template that the
/// tracker had.
class LostLandmarks {
 public:
  explicit LostLandmarks(const GuidanceOptions& options) : options_(options) {}

  /// Stores the landmark of a track that ended at t [s]. Its template `look`, turned by `angle` [rad], was seen from
  /// the guidance's camera pose at that time.
  void remember(TrackId track, double t, const Template& look, double angle, const Guidance& guidance);
  /// Whether any stored landmark is of another world than `world`.
  bool has_of_another(std::size_t world) const {
    return std::ranges::any_of(lost_, [&](const auto& entry) { return entry.second.world != world; });
  }
  void forget(TrackId track) { lost_.erase(track); }
  /// Removes the landmarks of a world whose map is gone: the poses that they were seen from are no longer known.
  void forget_world(std::size_t world) {
    std::erase_if(lost_, [&](const auto& entry) { return entry.second.world == world; });
  }
  /// Backs off after a re-acquired landmark turned out to be another one: it is not searched for during a pause. It
  /// need not be stored.
  void disappoint(TrackId track, double t);

  /// A landmark that is re-acquired.
  struct Found {
    TrackId track;
    Vector2 pixel;  ///< [px]
    Template look;  ///< its template as it is expected now
  };
  /// What trackers follow already.
  struct Tracked {
    std::vector<TrackId> tracks;
    std::vector<Vector2> places;  ///< [px]
    bool has(TrackId track) const { return std::ranges::find(tracks, track) != tracks.end(); }
  };
  /// Searches for some of the landmarks in view at t, in turn, beginning with those not searched for the longest.
  /// Leaves out landmarks that are tracked, or expected within `distance` [px] of a tracked one.
  std::vector<Found> find(const Guidance& guidance, double t, const RecentEvents& recent, const Tracked& tracked,
                          double distance, const Camera& camera);

  /// Finds landmarks that are displaced together, as happens when the back-end's camera pose is off: those that agree
  /// on one camera motion, if they are a large enough share of all that match anywhere. Searches at intervals.
  std::vector<Found> find_displaced(const Guidance& guidance, double t, const RecentEvents& recent,
                                    const Tracked& tracked, const Camera& camera);

  /// Recognises a landmark of another world than `world` around a position [px] by its template alone, whatever the
  /// image position and rotation. Leaves out landmarks that are tracked. None where two match about equally well.
  std::optional<Found> recognise(const Vector2& about, std::size_t world, const RecentEvents& recent, double t,
                                 const Tracked& tracked);

 private:
  struct Lost {
    double t;      ///< [s] when it was lost
    double tried;  ///< [s] time of the last search for it, or of the next one
    Template look;
    double angle;
    SE3 T_world_camera;
    std::size_t world;
  };
  /// A landmark that is predicted in view.
  struct Candidate {
    TrackId track;
    Vector2 expected;  ///< [px]
    double tried;      ///< [s]
  };

  void forget_before(double t);
  std::vector<Candidate> expected_in_view(const Guidance& guidance, double t, const Tracked& tracked,
                                          const Camera& camera) const;
  Found as_expected(TrackId track, const Lost& lost, const Guidance& guidance, double t) const;
  std::optional<Found> look_for(TrackId track, const Lost& lost, const Guidance& guidance, const Vector2& about,
                                const RecentEvents& recent) const;

  GuidanceOptions options_;
  std::map<TrackId, Lost> lost_;
  double next_displaced_ = 0.0;  ///< [s] time of the next search for displaced ones
};

}  // namespace evbench::haste
