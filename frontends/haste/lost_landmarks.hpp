#pragma once

#include <map>
#include <optional>
#include <span>

#include "frontends/haste/guidance.hpp"
#include "frontends/haste/options.hpp"
#include "frontends/haste/recent_events.hpp"
#include "frontends/haste/tracking/template.hpp"

namespace evbench::haste {

/// Landmarks whose trackers have ended, each as it looked then, to be found again where the back-end expects them.
class LostLandmarks {
 public:
  explicit LostLandmarks(const GuidanceOptions& options) : options_(options) {}

  /// The landmark of a track that ended at t [s]: its template, turned by `angle` [rad], was seen from a pose.
  void remember(TrackId track, double t, const Template& look, double angle, const SE3& T_world_camera);
  void forget(TrackId track) { lost_.erase(track); }
  /// One that was found and turned out to be another: it is left alone for a while.
  void disappoint(TrackId track, double t);

  /// A landmark that has been found.
  struct Found {
    TrackId track;
    Vector2 pixel;  ///< [px]
    Template look;  ///< as it is expected now
  };
  /// Looks for some of the landmarks in view at t, in turn, those first that were not looked for the longest. None
  /// that is expected within `distance` of what is `taken` [px].
  std::vector<Found> find(const Guidance& guidance, double t, const RecentEvents& recent,
                          std::span<const Vector2> taken, double distance, const Camera& camera);

 private:
  struct Lost {
    double t;      ///< [s] when it was lost
    double tried;  ///< [s] when it was last looked for, or will be next
    Template look;
    double angle;
    SE3 T_world_camera;
  };
  std::optional<Found> look_for(TrackId track, const Lost& lost, const Guidance& guidance, const Vector2& about,
                                const RecentEvents& recent) const;

  GuidanceOptions options_;
  std::map<TrackId, Lost> lost_;
};

}  // namespace evbench::haste
