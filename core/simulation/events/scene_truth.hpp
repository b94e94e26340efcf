#pragma once

#include <memory>
#include <optional>

#include "core/geometry/camera.hpp"
#include "core/plugin/point_truth.hpp"
#include "core/simulation/motion.hpp"
#include "core/simulation/rendering/rendered_scene.hpp"

namespace evbench {

/// The truth about a simulated recording at any time t [s]: pose, depth, tracks.
class SceneTruth : public PointTruth {
 public:
  SceneTruth(const Camera& camera, std::shared_ptr<const RenderedScene> scene, Motion motion);

  SE3 pose(double t) const { return motion_(t); }  ///< T_world_camera

  /// Depth along the camera's z [m] at a raw pixel; none if the lens model has no inverse there or nothing is seen.
  std::optional<double> depth(const Vector2& pixel, double t) const;

  std::optional<Vector3> point(const Vector2& pixel, double t) const override;
  std::optional<Vector2> pixel(const Vector3& point, double t) const override;

  /// Is nothing in front of the point?
  bool unoccluded(const SE3& T_world_camera, const Vector3& point) const;

 private:
  Camera camera_;
  std::shared_ptr<const RenderedScene> scene_;
  Motion motion_;
};

}  // namespace evbench
