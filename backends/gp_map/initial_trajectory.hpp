#pragma once

#include <map>
#include <span>
#include <vector>

#include "backends/gp_map/options.hpp"
#include "core/motion/gp_interval.hpp"
#include "core/structure/point_image.hpp"
#include "core/structure/track_buffer.hpp"

namespace evbench::gp_map {

/// The control states of an initial map, each by resection: along the views that it was found from, then back in time as
/// far as tracks that are landmarks, or that can be triangulated on the way, reach.
class InitialTrajectory {
 public:
  InitialTrajectory(const TrackBuffer& tracks, const PinholeCamera& camera, const Options& options,
                  const PlaceWindow& window)
      : tracks_(tracks), camera_(camera), options_(options), window_(window) {}

  void add_landmark(TrackId track, const InversePoint& point) { landmarks_[track] = point; }

  /// The states stand at some of these times, which end with the last view's.
  void go_along(std::span<const SE3> views, std::span<const double> view_times, std::span<const double> state_times);

  const std::vector<ControlState>& states() const { return states_; }
  /// Times of the stand before the first view at which no state stands [s].
  const std::vector<double>& passed_over() const { return passed_over_; }
  const std::map<TrackId, InversePoint>& landmarks() const { return landmarks_; }

 private:
  struct Sightings {
    std::vector<InversePoint> points;
    std::vector<Vector2> pixels;
  };
  Sightings sightings(double t) const;
  bool go_back_to(double t);
  bool is_still(double t) const;
  void triangulate_at(double t);
  void take_velocities();

  const TrackBuffer& tracks_;
  PinholeCamera camera_;
  const Options& options_;
  PlaceWindow window_;
  std::map<TrackId, InversePoint> landmarks_;
  double first_view_ = 0.0;  ///< [s]
  bool begins_with_stand_ = false;
  std::vector<double> passed_over_;
  std::vector<ControlState> states_;  ///< in time order; while going back, the newest first
};

}  // namespace evbench::gp_map
