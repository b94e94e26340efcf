#pragma once

#include <map>
#include <span>
#include <vector>

#include "backends/gp_map/options.hpp"
#include "core/motion/gp_interval.hpp"
#include "core/structure/point_image.hpp"
#include "core/structure/track_buffer.hpp"

namespace evbench::gp_map {

/// The control states of an initial map, each by resection: along the views of its estimate, then back in time as far
/// as there are tracks that are landmarks or can be triangulated.
class InitialTrajectory {
 public:
  InitialTrajectory(const TrackBuffer& tracks, const PinholeCamera& camera, const Options& options,
                    const PlaceWindow& window)
      : tracks_(tracks), camera_(camera), options_(options), window_(window) {}

  void add_landmark(TrackId track, const InversePoint& point) { landmarks_[track] = point; }

  /// Estimates states at some of these times, which end with the last view's.
  void follow_views(std::span<const SE3> views, std::span<const double> view_times,
                    std::span<const double> state_times);

  const std::vector<ControlState>& states() const { return states_; }
  /// Times in the stationary period before the first view without a state [s].
  const std::vector<double>& skipped() const { return skipped_; }
  const std::map<TrackId, InversePoint>& landmarks() const { return landmarks_; }

 private:
  struct Sightings {
    std::vector<InversePoint> points;
    std::vector<Vector2> pixels;
  };
  Sightings sightings(double t) const;
  bool extend_back_to(double t);
  bool is_stationary(double t) const;
  void triangulate_at(double t);
  void take_velocities();

  const TrackBuffer& tracks_;
  PinholeCamera camera_;
  const Options& options_;
  PlaceWindow window_;
  std::map<TrackId, InversePoint> landmarks_;
  double first_view_ = 0.0;  ///< [s]
  bool begins_stationary_ = false;
  std::vector<double> skipped_;
  std::vector<ControlState> states_;  ///< in time order; while going back, the newest first
};

}  // namespace evbench::gp_map
