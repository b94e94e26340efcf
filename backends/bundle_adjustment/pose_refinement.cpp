#include "backends/bundle_adjustment/pose_refinement.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <optional>

#include "core/geometry/so3.hpp"
#include "core/geometry/solve_symmetric.hpp"
#include "core/support/median.hpp"

namespace evbench::bundle_adjustment {
namespace {

struct Sighting {
  Vector3 landmark;
  Vector2 pixel;
  Whitening whitening;
};

struct Linearisation {
  Matrix6 H = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  double cost = 0.0;
};

Linearisation linearise(const SE3& T, const std::vector<Sighting>& sightings, const PinholeCamera& camera,
                        const ceres::LossFunction* loss) {
  Linearisation result;
  for (const Sighting& z : sightings) {
    ReprojectionJacobians J;
    const Vector2 error = z.whitening * reprojection_error(T, z.landmark, z.pixel, camera, J);
    const Matrix26 jacobian = z.whitening * J.pose;
    double rho[3] = {error.squaredNorm(), 1.0, 0.0};
    if (loss != nullptr) loss->Evaluate(error.squaredNorm(), rho);
    result.cost += 0.5 * rho[0];
    result.H += rho[1] * jacobian.transpose() * jacobian;
    result.g += rho[1] * jacobian.transpose() * error;
  }
  return result;
}

SE3 refine(SE3 T, const std::vector<Sighting>& sightings, const PinholeCamera& camera,
           const ceres::LossFunction* loss) {
  Linearisation at = linearise(T, sightings, camera, loss);
  double damping = 1e-6;
  for (int iteration = 0; iteration < 30; ++iteration) {
    Matrix6 H = at.H;
    H.diagonal() *= 1.0 + damping;
    const Vector6 step = solve_symmetric(H, -at.g);
    if (!step.allFinite()) break;
    const SE3 trial = T * se3::exp(step);
    const Linearisation next = linearise(trial, sightings, camera, loss);
    if (!(next.cost < at.cost)) {
      if (damping > 1e6) break;
      damping = std::max(10.0 * damping, 1e-4);
      continue;
    }
    const bool converged = at.cost - next.cost < 1e-6 * at.cost;
    T = trial;
    at = next;
    damping *= 0.1;
    if (converged) break;
  }
  return T;
}

double median_error(const SE3& T, const std::vector<Sighting>& sightings, const PinholeCamera& camera) {
  std::vector<double> errors;
  for (const Sighting& z : sightings) errors.push_back(reprojection_error(T, z.landmark, z.pixel, camera).norm());
  return median(std::move(errors));
}

std::optional<SE3> pnp(const std::vector<Sighting>& sightings, const PinholeCamera& camera, double limit_px) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const Sighting& z : sightings) {
    points.emplace_back(z.landmark.x(), z.landmark.y(), z.landmark.z());
    pixels.emplace_back(z.pixel.x(), z.pixel.y());
  }
  const cv::Matx33d K(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
  cv::Vec3d rotation, translation;
  try {
    if (!cv::solvePnPRansac(points, pixels, K, cv::noArray(), rotation, translation, false, 100,
                            static_cast<float>(limit_px))) {
      return std::nullopt;
    }
  } catch (const cv::Exception&) {
    return std::nullopt;  // too few or degenerate points
  }
  const SE3 T_camera_world{so3::exp({rotation[0], rotation[1], rotation[2]}),
                           {translation[0], translation[1], translation[2]}};
  if (!T_camera_world.p.allFinite() || !T_camera_world.q.coeffs().allFinite()) return std::nullopt;
  return T_camera_world.inverse();
}

}  // namespace

PoseEstimate estimate_pose(const SE3& prediction, const Reconstruction& map, std::span<const Keypoint> keypoints,
                           const PinholeCamera& camera, const ceres::LossFunction* loss, double limit_px) {
  std::vector<Sighting> sightings;
  for (const Keypoint& z : keypoints)
    sightings.push_back({*map.tracks.at(z.track).position, z.pixel, z.noise.whitening()});
  PoseEstimate result{refine(prediction, sightings, camera, loss), 0.0};
  result.median_px = median_error(result.T, sightings, camera);
  if (result.median_px <= limit_px) return result;
  if (const std::optional<SE3> start = pnp(sightings, camera, limit_px)) {
    const SE3 T = refine(*start, sightings, camera, loss);
    const double error = median_error(T, sightings, camera);
    if (error < result.median_px) result = {T, error};
  }
  return result;
}

}  // namespace evbench::bundle_adjustment
