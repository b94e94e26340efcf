#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/render/palette.hpp"
#include "core/events/event.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// How many events of each polarity a pixel has; fractions where events fall between pixels.
struct PolarityCounts {
  cv::Mat1f on, off;
};

/// Warps events along a known motion to where the camera would see their edges at one time (the image of warped events
/// of Gallego et al., CVPR 2018, with a known instead of an estimated motion). Without a depth only the rotation is
/// used. With a depth the whole pose is used, and all edges are taken to lie on the plane z = depth of the camera at
/// the reference time.
class MotionCompensation {
 public:
  /// `camera` with the sensor's size; `depth` [m]; `name`: the trajectory's, for messages.
  MotionCompensation(const PoseTrajectory& trajectory, const Camera& camera, std::optional<double> depth,
                     std::string name);

  /// Events shared among the four pixels around them, in the raw image at time `reference` [µs]; events outside the
  /// image are left out. `zero` [µs] is the trajectory's time at the events' zero.
  /// Throws InputError when the trajectory does not reach an event, or the reference.
  PolarityCounts accumulate(std::span<const Event> events, std::int64_t reference, std::int64_t zero = 0) const;

 private:
  SE3 pose(std::int64_t t) const;
  std::optional<Vector2> project(const SE3& T_reference_event, const Vector3& ray) const;

  const PoseTrajectory* trajectory_;
  Camera camera_;
  std::optional<double> depth_;
  std::string name_;
  std::vector<std::optional<Vector3>> rays_;  ///< by pixel, of the ideal pinhole; none where the lens has no inverse
  Vector2 ray_min_, ray_max_;                 ///< their x and y
};

/// Draws counts: colours are stronger for more events, full at the 95 % quantile of the pixels with events; the
/// polarities' colours mix.
Picture draw_counts(const PolarityCounts& counts, const Palette& palette);

}  // namespace evbench
