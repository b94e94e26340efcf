#pragma once

#include <map>
#include <optional>
#include <vector>

#include "backends/bundle_adjustment/frames.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/structure/triangulation.hpp"

namespace evbench::bundle_adjustment {

/// A frame's pose. Predicted ones are guesses that take no part in triangulation or optimisation.
struct View {
  enum class State { unknown, predicted, estimated };
  double t = 0.0;
  SE3 T;  ///< T_world_camera
  State state = State::unknown;
  std::vector<Keypoint> keypoints;

  bool estimated() const { return state == State::estimated; }
};

struct TrackSighting {
  int view = 0;
  Vector2 pixel = Vector2::Zero();
  double sigma = 1.0;
};

struct Track {
  std::vector<TrackSighting> sightings;  ///< in time order
  std::optional<Vector3> position;       ///< world frame: the track is a landmark
};

/// The views, the tracks that they see, and the landmarks among them.
struct Reconstruction {
  std::vector<View> views;
  std::map<TrackId, Track> tracks;

  int add(const Frame& frame);  ///< returns the new view's index
  void remove(TrackId track);   ///< with its keypoints

  /// Starts afresh at a view: tracks seen since then lose their older sightings and are no landmarks any more.
  void cut_tracks(int view);

  std::vector<Keypoint> landmarks_in(int view) const;  ///< the view's keypoints of landmarks

  /// What a track must have before it can become a landmark.
  struct Maturity {
    int views = 3;
    double time = 0.0;  ///< [s], from its first to its last view
  };

  /// Triangulates the newest view's tracks that are no landmarks yet from the estimated views that see them.
  void triangulate_new(const PinholeCamera& camera, const TriangulationOptions& options, const Maturity& needed);

  /// Tracks that are landmarks seen since view `first`, whose mean reprojection error over all estimated views
  /// exceeds `limit_px` even after they have been triangulated anew.
  std::vector<TrackId> outliers(const PinholeCamera& camera, double limit_px, int first);

  /// How many times as large as their sigmas say the reprojection errors are that landmarks have in the estimated views
  /// from `first` on: by the median, which outliers don't move. None without errors.
  std::optional<double> noise_factor(const PinholeCamera& camera, int first) const;

  /// Mean norm of a landmark's reprojection error over the estimated views that see it [px].
  double mean_error(const Track& track, const PinholeCamera& camera) const;

 private:
  Triangulation triangulate_track(const Track& track, const PinholeCamera& camera,
                                  const TriangulationOptions& options) const;
};

}  // namespace evbench::bundle_adjustment
