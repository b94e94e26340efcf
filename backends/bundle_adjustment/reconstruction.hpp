#pragma once

#include <map>
#include <optional>
#include <vector>

#include "backends/bundle_adjustment/batches.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/structure/triangulation.hpp"

namespace evbench::bundle_adjustment {

/// The pose of a batch. Predicted poses are guesses that take no part in triangulation or optimisation.
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
  PixelNoise noise = 1.0;
};

struct Track {
  std::vector<TrackSighting> sightings;  ///< in time order
  std::optional<Vector3> position;       ///< world frame: the track is a landmark
};

/// The views, the tracks that they see, and the landmarks among them.
struct Reconstruction {
  std::vector<View> views;
  std::map<TrackId, Track> tracks;

  int add(const Batch& batch);  ///< returns the new view's index
  void remove(TrackId track);   ///< with its keypoints

  /// Starts again at a view: tracks seen since then lose their older sightings and are no longer landmarks.
  void cut_tracks(int view);

  std::vector<Keypoint> landmarks_in(int view) const;  ///< the view's keypoints of landmarks

  /// What a track must have before it can become a landmark.
  struct Maturity {
    int views = 3;
    double time = 0.0;  ///< [s], from its first to its last view
  };

  /// Triangulates the newest view's tracks that are no landmarks yet from the estimated views that see them.
  void triangulate_new(const PinholeCamera& camera, const TriangulationOptions& options, const Maturity& needed);

  /// Tracks that are landmarks seen since view `first`, whose mean reprojection error over all estimated views exceeds
  /// `limit_px` even after they have been triangulated again.
  std::vector<TrackId> outliers(const PinholeCamera& camera, double limit_px, int first);

  /// Ratio of the landmarks' reprojection errors, in the estimated views from `first` on, to their sigmas: a median,
  /// which is robust to outliers. None without errors.
  std::optional<double> noise_factor(const PinholeCamera& camera, int first) const;

  /// Mean norm of a landmark's reprojection error over the estimated views that see it [px].
  double mean_error(const Track& track, const PinholeCamera& camera) const;

 private:
  Triangulation triangulate_track(const Track& track, const PinholeCamera& camera,
                                  const TriangulationOptions& options) const;
};

}  // namespace evbench::bundle_adjustment
