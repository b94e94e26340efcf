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

/// Landmarks whose trackers have ended, to be found again where the back-end expects them: by how they looked then, or,
/// where that is not known or not found, as corners.
class LostLandmarks {
 public:
  explicit LostLandmarks(const GuidanceOptions& options) : options_(options) {}

  /// The landmark of a track that ended at t [s]: its template, turned by `angle` [rad], was seen from where the
  /// guidance has the camera then.
  void remember(TrackId track, double t, const Template& look, double angle, const Guidance& guidance);
  /// Whether any is of another world than this one.
  bool has_of_another(std::size_t world) const {
    return std::ranges::any_of(lost_, [&](const auto& entry) { return entry.second.world != world; });
  }
  void forget(TrackId track) { lost_.erase(track); }
  /// Those of this world, whose map is gone: from where they were seen is not known any more.
  void forget_world(std::size_t world) {
    std::erase_if(lost_, [&](const auto& entry) { return entry.second.world == world; });
  }
  /// One that was found and turned out to be another: it is left alone for a while. It need not be remembered.
  void disappoint(TrackId track, double t);

  /// A landmark that has been found.
  struct Found {
    TrackId track;
    Vector2 pixel;  ///< [px]
    Template look;  ///< as it is expected now
  };
  /// What has a tracker.
  struct Tracked {
    std::vector<TrackId> tracks;
    std::vector<Vector2> places;  ///< [px]
    bool has(TrackId track) const { return std::ranges::find(tracks, track) != tracks.end(); }
  };
  /// Looks for some of the landmarks in view at t, in turn, those first that were not looked for the longest. None
  /// that is tracked, or expected within `distance` of what is [px].
  std::vector<Found> find(const Guidance& guidance, double t, const RecentEvents& recent, const Tracked& tracked,
                          double distance, const Camera& camera);

  /// Where the camera is not where the back-end has it, one motion of it displaces most of them: those that agree on
  /// one, if they are enough of those that are seen at all. Looks now and then.
  std::vector<Found> find_displaced(const Guidance& guidance, double t, const RecentEvents& recent,
                                    const Tracked& tracked, const Camera& camera);

  /// The landmark of another world than this one that is seen about a place [px] by its look alone, which the camera
  /// may have turned: it may be anywhere. None of those that are tracked; none where two look as much so.
  std::optional<Found> recognise(const Vector2& about, std::size_t world, const RecentEvents& recent, double t,
                                 const Tracked& tracked);

  /// The landmark that a corner [px] seen at t is, if it is one that nobody tracks: the only such one that is expected
  /// there. None where two are.
  std::optional<TrackId> at_corner(const Vector2& corner, const Guidance& guidance, double t,
                                   const Tracked& tracked) const;

 private:
  struct Lost {
    double t;      ///< [s] when it was lost
    double tried;  ///< [s] when it was last looked for, or will be next
    Template look;
    double angle;
    SE3 T_world_camera;
    std::size_t world;
  };
  /// One that is in view, as far as is known.
  struct Candidate {
    TrackId track;
    Vector2 expected;  ///< [px]
    double tried;      ///< [s]
  };

  void forget_before(double t);
  std::vector<Candidate> expected_in_view(const Guidance& guidance, double t, const Tracked& tracked,
                                          const Camera& camera) const;
  Found as_expected(TrackId track, const Lost& lost, const Guidance& guidance, double t) const;
  bool is_left_alone(TrackId track, double t) const;
  std::optional<Found> look_for(TrackId track, const Lost& lost, const Guidance& guidance, const Vector2& about,
                                const RecentEvents& recent) const;

  GuidanceOptions options_;
  std::map<TrackId, Lost> lost_;
  double next_displaced_ = 0.0;           ///< [s] when displaced ones are looked for next
  std::map<TrackId, double> left_alone_;  ///< no corner is taken for it until then [s]
};

}  // namespace evbench::haste
