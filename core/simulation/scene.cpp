#include "core/simulation/scene.hpp"

#include <fmt/format.h>

#include <limits>

#include "core/simulation/layout.hpp"
#include "core/support/error.hpp"

namespace evbench {

void SceneOptions::declare(OptionSet& set) {
  set.add("kind", kind, "scene in view of the camera").choices({"volume", "plane", "boxes", "frustum"});
  set.add("points", points, "number of dots (not frustum)").range(1, 1e6);
  set.add("near", near, "smallest depth of dots seen from the path [m]").above(0.0);
  set.add("far", far, "largest depth of dots seen from the path [m]").above(0.0);
  set.add("boxes", boxes, "number of boxes").range(1, 1e4);
}

std::optional<Vector2> visible_pixel(const Camera& camera, const SE3& T_world_camera, const Vector3& point,
                                     double border) {
  const Vector3 q = T_world_camera.inverse() * point;
  if (q.z() < 1e-3) return std::nullopt;
  const Vector2 raw = camera.project(q);
  if (!camera.contains(raw, border)) return std::nullopt;
  if (camera.distortion != DistortionModel::none) {
    // Beyond its valid range a lens polynomial folds back and maps far-off points into the image.
    const std::optional<Vector2> ideal = camera.undistort(raw);
    if (!ideal || (*ideal - camera.pinhole.project(q)).norm() > 1e-3) return std::nullopt;
  }
  return raw;
}

Scene::Scene(const SceneOptions& options, const Camera& camera, const Motion& motion, double duration, Random random)
    : options_(options), camera_(camera) {
  if (!(options.near < options.far)) {
    throw InputError(fmt::format("scene: near is {} m and far {} m; expected near < far", options.near, options.far));
  }
  if (options.kind == "frustum") return;
  const SceneLayout layout(camera, sample_motion(motion, duration, 10.0));
  const Eigen::AlignedBox3d box = options.kind == "plane" ? layout.viewed_rectangle(0.5 * (options.near + options.far))
                                                          : layout.viewed_volume(options.near, options.far);
  std::vector<UprightBox> boxes;
  if (options.kind == "boxes") {
    for (int i = 0; i < options.boxes; ++i) boxes.emplace_back(box, random);
  }
  for (int i = 0; i < options.points; ++i) {
    const Vector3 local =
        boxes.empty() ? point_in(box, random) : boxes[random.index(boxes.size())].point_on_face(random);
    points_.push_back(layout.frame * local);
  }
  busy_until_.assign(points_.size(), -std::numeric_limits<double>::infinity());
}

Scene::Scene(std::vector<Vector3> points, const Camera& camera, Visibility unoccluded)
    : camera_(camera), points_(std::move(points)), unoccluded_(std::move(unoccluded)) {
  busy_until_.assign(points_.size(), -std::numeric_limits<double>::infinity());
}

std::optional<Vector2> Scene::pixel(const SE3& T_world_camera, const Vector3& point, double border) const {
  const std::optional<Vector2> raw = visible_pixel(camera_, T_world_camera, point, border);
  return raw && unoccluded_ && !unoccluded_(T_world_camera, point) ? std::nullopt : raw;
}

std::optional<Scene::Pick> Scene::pick(double t, const SE3& T_world_camera, double border, Random& random) const {
  if (options_.kind == "frustum") {
    const Vector2 raw = random.uniform2({border, border}, {camera_.width - 1 - border, camera_.height - 1 - border});
    const double depth = random.uniform(options_.near, options_.far);
    const std::optional<Vector2> ideal = camera_.undistort(raw);
    if (!ideal) return std::nullopt;
    return Pick{T_world_camera * (depth * camera_.pinhole.ray(*ideal)), std::nullopt};
  }
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (busy_until_[i] < t && pixel(T_world_camera, points_[i], border)) candidates.push_back(i);
  }
  if (candidates.empty()) return std::nullopt;
  const std::size_t chosen = candidates[random.index(candidates.size())];
  return Pick{points_[chosen], chosen};
}

void Scene::occupy(const Pick& pick, double until) {
  if (pick.point) busy_until_[*pick.point] = until;
}

}  // namespace evbench
