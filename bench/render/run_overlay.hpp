#pragma once

#include <map>
#include <string>
#include <vector>

#include "bench/render/palette.hpp"
#include "core/data/landmark.hpp"
#include "core/data/track.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// Draws a run over and next to its events: the landmarks of its final estimate in the image, which of them are
/// tracked, and the camera's trajectory. A run that failed has only tracks.
class RunOverlay {
 public:
  /// Throws InputError for a folder that is not a run's, or was made without --tracks.
  RunOverlay(const std::string& folder, const Camera& camera);

  /// In time order.
  const std::vector<TrackObservation>& tracks() const { return tracks_; }

  /// What can't be drawn correctly, and why; empty where everything can.
  const std::string& remark() const { return remark_; }

  /// Landmarks over a picture of the sensor at t [s], each pixel of it `scale` pixels wide: a ring where it is tracked,
  /// a bold ring for a while after it is re-acquired, a cross where it was seen before and is not now.
  void draw_landmarks(double t, int scale, const Palette& palette, Picture& picture) const;

  /// A square picture of this size [px]: ground truth and the estimate up to t, where available, aligned by Sim(3), in
  /// the two directions of their largest extent.
  Picture draw_trajectory(double t, int size, const Palette& palette) const;

 private:
  enum class Sight { unseen, tracked, found_again, lost };
  Sight sight_of(TrackId track, double t) const;

  Camera camera_;
  std::vector<TrackObservation> tracks_;
  std::map<TrackId, std::vector<double>> times_;  ///< [s] of each track's observations
  std::vector<Landmark> map_;
  PoseTrajectory estimate_;  ///< in the back-end's frame
  std::vector<StampedPose> aligned_, truth_;
  std::string remark_;
};

}  // namespace evbench
