#include "bench/report/newest_poses.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "bench/report/column.hpp"
#include "core/data/relative_poses.hpp"
#include "core/geometry/so3.hpp"
#include "core/io/file_content.hpp"

namespace evbench::report {
namespace {

/// Roll, pitch and yaw [deg], R = Rz(yaw) Ry(pitch) Rx(roll).
Vector3 angles_deg(const Matrix3& R) {
  return kDegrees * Vector3(std::atan2(R(2, 1), R(2, 2)), std::asin(std::clamp(-R(2, 0), -1.0, 1.0)),
                            std::atan2(R(1, 0), R(0, 0)));
}

Vector3 turned_least(Vector3 degrees) {
  for (double& angle : degrees) angle -= 360.0 * std::round(angle / 360.0);
  return degrees;
}

}  // namespace

Json newest_json(const RunRecord& run, const ScoredTrajectory& scored, const PoseTrajectory& truth,
                 const Budget& budget) {
  const std::string path = run.folder + "/covariance.txt";
  if (!is_file(path)) return nullptr;
  std::vector<RelativePose> newest;
  for (RelativePose& pose : read_relative_poses(path)) {
    if (pose.kind == "newest") newest.push_back(std::move(pose));
  }
  std::map<double, SE3> published;
  const PoseTrajectory causal = read_run_poses(run.folder, {.causal = true});
  for (const StampedPose& pose : causal.poses()) published[pose.t] = pose.T;
  const Similarity alignment = scored.alignment();
  std::vector<double> t;
  std::vector<Vector3> p, sigma_m, sigma_deg, error_m, error_deg;
  std::vector<Eigen::Quaterniond> q;
  for (const std::size_t i : thinned(newest.size(), budget.covariances())) {
    const RelativePose& relative = newest[i];
    const auto found = published.lower_bound(relative.t1 - 1e-6);
    if (found == published.end() || found->first > relative.t1 + 1e-6) continue;
    const SE3 T = alignment * found->second;
    const Matrix3 R = T.R();
    const Matrix3 position =
        alignment.scale * alignment.scale * (R * relative.covariance.bottomRightCorner<3, 3>() * R.transpose());
    Matrix3 J;  // of the angles, for R Exp(δ)
    constexpr double kStep = 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3 step = kStep * Vector3::Unit(axis);
      const Matrix3 ahead = (T.q * so3::exp(step)).toRotationMatrix(),
                    behind = (T.q * so3::exp(-step)).toRotationMatrix();
      J.col(axis) = turned_least(angles_deg(ahead) - angles_deg(behind)) / (2.0 * kStep);
    }
    const Matrix3 rotation = J * relative.covariance.topLeftCorner<3, 3>() * J.transpose();
    t.push_back(relative.t1 + scored.offset());
    p.push_back(T.p);
    q.push_back(on_one_side(q, T.q));
    sigma_m.push_back(position.diagonal().cwiseMax(0.0).cwiseSqrt());
    sigma_deg.push_back(rotation.diagonal().cwiseMax(0.0).cwiseSqrt());
    const std::optional<SE3> true_pose = truth.empty() ? std::nullopt : truth.pose(t.back());
    error_m.push_back(true_pose ? Vector3(T.p - true_pose->p) : kNoVector);
    error_deg.push_back(true_pose ? turned_least(angles_deg(R) - angles_deg(true_pose->R())) : kNoVector);
  }
  if (t.empty()) return nullptr;
  return {{"t", times(t)},
          {"p", vectors(p)},
          {"q", orientations(q)},
          {"sigma_m", vectors(sigma_m)},
          {"sigma_deg", vectors(sigma_deg)},
          {"error_m", vectors(error_m)},
          {"error_deg", vectors(error_deg)}};
}

}  // namespace evbench::report
