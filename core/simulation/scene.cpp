#include "core/simulation/scene.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/support/error.hpp"

namespace evbench {
namespace {

using Box = Eigen::AlignedBox3d;

/// The frame in which scenes are laid out: mean position and mean orientation of the camera.
SE3 mean_view(const PoseTrajectory& path) {
  Vector3 position = Vector3::Zero();
  Eigen::Matrix4d moment =
      Eigen::Matrix4d::Zero();  // its main eigenvector is the mean rotation, whatever the signs of q
  for (const StampedPose& pose : path.poses()) {
    position += pose.T.p;
    moment += pose.T.q.coeffs() * pose.T.q.coeffs().transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(moment);
  const Eigen::Vector4d q = solver.eigenvectors().col(3);
  return {Eigen::Quaterniond(q).normalized(), position / static_cast<double>(path.size())};
}

/// The rays of the image's corners and of the middles of its sides, through the lens where it can be inverted.
std::vector<Vector3> border_rays(const Camera& camera) {
  std::vector<Vector3> rays;
  for (const double x : {0.0, 0.5, 1.0}) {
    for (const double y : {0.0, 0.5, 1.0}) {
      const Vector2 raw(x * (camera.width - 1), y * (camera.height - 1));
      rays.push_back(camera.pinhole.ray(camera.undistort(raw).value_or(raw)));
    }
  }
  return rays;
}

/// The box, in the scene's frame, that holds all views between depths near and far.
Box viewed_volume(const PoseTrajectory& path, const SE3& frame, const std::vector<Vector3>& rays, double near,
                  double far) {
  Box box;
  for (const StampedPose& pose : path.poses()) {
    const SE3 T = frame.inverse() * pose.T;
    for (const Vector3& ray : rays) {
      box.extend(T * (near * ray));
      box.extend(T * (far * ray));
    }
  }
  return box;
}

/// The rectangle, in the scene's frame, that the views cover on the plane z = depth. Rays that run along the plane or
/// away from it are cut at five times the depth, which keeps the dots dense where the camera mostly looks.
Box viewed_rectangle(const PoseTrajectory& path, const SE3& frame, const std::vector<Vector3>& rays, double depth) {
  const double limit = 5.0 * depth;
  Box box;
  for (const StampedPose& pose : path.poses()) {
    const SE3 T = frame.inverse() * pose.T;
    for (const Vector3& ray : rays) {
      const Vector3 direction = T.q * ray;
      const double length = std::max(depth - T.p.z(), 0.0) / std::max(direction.z(), 1e-3);
      const Vector3 hit = T.p + length * direction;
      box.extend(Vector3(std::clamp(hit.x(), -limit, limit), std::clamp(hit.y(), -limit, limit), depth));
    }
  }
  return box;
}

Vector3 point_in(const Box& box, Random& random) {
  Vector3 point;
  for (Eigen::Index axis = 0; axis < 3; ++axis) point[axis] = random.uniform(box.min()[axis], box.max()[axis]);
  return point;
}

/// A box standing in the volume, turned about its vertical axis, with edges of 5 to 20 % of the volume's mean edge.
struct StandingBox {
  Vector3 centre, half;
  Eigen::Quaterniond turn;

  StandingBox(const Box& volume, Random& random) : centre(point_in(volume, random)) {
    const double edge = volume.sizes().mean();
    for (double& h : half) h = 0.5 * edge * random.uniform(0.05, 0.2);
    turn = Eigen::AngleAxisd(random.uniform(0.0, 2.0 * M_PI), Vector3::UnitY());
  }

  Vector3 point_on_face(Random& random) const {
    const auto axis = static_cast<Eigen::Index>(random.index(3));
    Vector3 local;
    for (Eigen::Index i = 0; i < 3; ++i) local[i] = half[i] * random.uniform(-1.0, 1.0);
    local[axis] = random.uniform() < 0.5 ? -half[axis] : half[axis];
    return centre + turn * local;
  }
};

}  // namespace

void SceneOptions::declare(OptionSet& set) {
  set.add("kind", kind, "what the camera looks at").choices({"volume", "plane", "boxes", "frustum"});
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
  const PoseTrajectory path = sample_motion(motion, duration, 10.0);
  const SE3 frame = mean_view(path);
  const std::vector<Vector3> rays = border_rays(camera);
  const Box box = options.kind == "plane" ? viewed_rectangle(path, frame, rays, 0.5 * (options.near + options.far))
                                          : viewed_volume(path, frame, rays, options.near, options.far);
  std::vector<StandingBox> boxes;
  if (options.kind == "boxes") {
    for (int i = 0; i < options.boxes; ++i) boxes.emplace_back(box, random);
  }
  for (int i = 0; i < options.points; ++i) {
    const Vector3 local =
        boxes.empty() ? point_in(box, random) : boxes[random.index(boxes.size())].point_on_face(random);
    points_.push_back(frame * local);
  }
  busy_until_.assign(points_.size(), -std::numeric_limits<double>::infinity());
}

std::optional<Scene::Pick> Scene::pick(double t, const SE3& T_world_camera, double border, Random& random) const {
  if (options_.kind == "frustum") {
    const Vector2 raw(random.uniform(border, camera_.width - 1 - border),
                      random.uniform(border, camera_.height - 1 - border));
    const double depth = random.uniform(options_.near, options_.far);
    const std::optional<Vector2> ideal = camera_.undistort(raw);
    if (!ideal) return std::nullopt;
    return Pick{T_world_camera * (depth * camera_.pinhole.ray(*ideal)), std::nullopt};
  }
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (busy_until_[i] < t && visible_pixel(camera_, T_world_camera, points_[i], border)) candidates.push_back(i);
  }
  if (candidates.empty()) return std::nullopt;
  const std::size_t chosen = candidates[random.index(candidates.size())];
  return Pick{points_[chosen], chosen};
}

void Scene::occupy(const Pick& pick, double until) {
  if (pick.point) busy_until_[*pick.point] = until;
}

}  // namespace evbench
