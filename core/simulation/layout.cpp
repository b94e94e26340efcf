#include "core/simulation/layout.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace evbench {
namespace {

using Box = Eigen::AlignedBox3d;

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

/// Through the lens where it can be inverted.
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

}  // namespace

SceneLayout::SceneLayout(const Camera& camera, PoseTrajectory camera_path)
    : frame(mean_view(camera_path)), path(std::move(camera_path)), rays(border_rays(camera)) {}

Box SceneLayout::viewed_volume(double near, double far) const {
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

Box SceneLayout::viewed_rectangle(double depth) const {
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

UprightBox::UprightBox(const Box& volume, Random& random) : centre(point_in(volume, random)) {
  const double edge = volume.sizes().mean();
  for (double& h : half) h = 0.5 * edge * random.uniform(0.05, 0.2);
  turn = Eigen::AngleAxisd(random.uniform(0.0, 2.0 * M_PI), Vector3::UnitY());
}

Vector3 UprightBox::point_on_face(Random& random) const {
  const auto axis = static_cast<Eigen::Index>(random.index(3));
  Vector3 local;
  for (Eigen::Index i = 0; i < 3; ++i) local[i] = half[i] * random.uniform(-1.0, 1.0);
  local[axis] = random.uniform() < 0.5 ? -half[axis] : half[axis];
  return centre + turn * local;
}

}  // namespace evbench
