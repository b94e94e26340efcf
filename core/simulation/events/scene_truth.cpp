#include "core/simulation/events/scene_truth.hpp"

#include "core/simulation/scene.hpp"

namespace evbench {

SceneTruth::SceneTruth(const Camera& camera, std::shared_ptr<const RenderedScene> scene, Motion motion)
    : camera_(camera), scene_(std::move(scene)), motion_(std::move(motion)) {}

std::optional<double> SceneTruth::depth(const Vector2& pixel, double t) const {
  const std::optional<Vector2> ideal = camera_.undistort(pixel);
  if (!ideal) return std::nullopt;
  const Hit hit = View(scene_->surfaces, motion_(t)).hit(camera_.pinhole.ray(*ideal).hnormalized());
  return hit.surface >= 0 ? std::optional(hit.depth) : std::nullopt;
}

std::optional<Vector3> SceneTruth::point(const Vector2& pixel, double t) const {
  const std::optional<double> z = depth(pixel, t);
  if (!z) return std::nullopt;
  return motion_(t) * (*z * camera_.pinhole.ray(*camera_.undistort(pixel)));
}

std::optional<Vector2> SceneTruth::pixel(const Vector3& point, double t) const {
  const SE3 T = motion_(t);
  const std::optional<Vector2> raw = visible_pixel(camera_, T, point, 0.0);
  return raw && unoccluded(T, point) ? raw : std::nullopt;
}

bool SceneTruth::unoccluded(const SE3& T_world_camera, const Vector3& point) const {
  constexpr double kTolerance = 1e-6;  // of the depth: the point's own surface is not in front of it
  const Vector3 local = T_world_camera.inverse() * point;
  if (local.z() <= 0.0) return false;
  const Hit hit = View(scene_->surfaces, T_world_camera).hit(local.hnormalized());
  return hit.surface < 0 || hit.depth > local.z() * (1.0 - kTolerance);
}

}  // namespace evbench
