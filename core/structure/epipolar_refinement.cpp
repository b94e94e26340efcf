#include "core/structure/epipolar_refinement.hpp"

#include <Eigen/LU>
#include <cmath>

#include "core/geometry/so3.hpp"
#include "core/geometry/solve_symmetric.hpp"
#include "core/geometry/tangent_plane.hpp"

namespace evbench {
namespace {

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

/// Normal equations of the Sampson distances. The derivative of their normalisation is neglected, because it changes
/// little over a step.
struct Linearisation {
  Matrix5 H = Matrix5::Zero();
  Vector5 g = Vector5::Zero();
  double cost = 0.0;
};

Linearisation linearise(const SE3& T, const std::vector<Vector3>& rays1, const std::vector<Vector3>& rays2,
                        double focal, double huber_px) {
  const Matrix3 R = T.R();
  const Matrix3 E = so3::hat(T.p) * R;
  const Eigen::Matrix<double, 3, 2> B = tangent_plane(T.p);
  Linearisation result;
  for (std::size_t i = 0; i < rays1.size(); ++i) {
    const Vector3 line1 = E * rays2[i];
    const Vector3 line2 = E.transpose() * rays1[i];
    const double scale = focal / std::sqrt(line1.head<2>().squaredNorm() + line2.head<2>().squaredNorm() + 1e-18);
    const double distance = scale * rays1[i].dot(line1);
    const bool linear = std::abs(distance) > huber_px;
    const double weight = linear ? huber_px / std::abs(distance) : 1.0;
    result.cost += linear ? huber_px * (std::abs(distance) - 0.5 * huber_px) : 0.5 * distance * distance;
    Vector5 J;
    J.head<3>() = scale * line2.cross(-rays2[i]);
    J.tail<2>() = scale * B.transpose() * (R * rays2[i]).cross(rays1[i]);
    result.H += weight * J * J.transpose();
    result.g += weight * distance * J;
  }
  return result;
}

}  // namespace

SE3 refine_relative_pose(const SE3& T_first_second, std::span<const Vector2> first, std::span<const Vector2> second,
                         const std::vector<bool>& use, const PinholeCamera& camera, double huber_px) {
  std::vector<Vector3> rays1, rays2;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (!use[i]) continue;
    rays1.push_back(camera.ray(first[i]));
    rays2.push_back(camera.ray(second[i]));
  }
  const double focal = 0.5 * (camera.fx + camera.fy);
  SE3 T = T_first_second;
  Linearisation at = linearise(T, rays1, rays2, focal, huber_px);
  double damping = 1e-6;
  for (int iteration = 0; iteration < 15; ++iteration) {
    Matrix5 H = at.H;
    H.diagonal() *= 1.0 + damping;
    const Vector5 step = solve_symmetric(H, -at.g);
    if (!step.allFinite()) break;
    const SE3 trial{(T.q * so3::exp(step.head<3>())).normalized(),
                    (T.p + tangent_plane(T.p) * step.tail<2>()).normalized()};
    const Linearisation next = linearise(trial, rays1, rays2, focal, huber_px);
    if (!(next.cost < at.cost)) {
      damping = std::max(10.0 * damping, 1e-4);
      continue;
    }
    const bool converged = at.cost - next.cost < 1e-8 * at.cost;
    T = trial;
    at = next;
    damping *= 0.1;
    if (converged) break;
  }
  return T;
}

}  // namespace evbench
