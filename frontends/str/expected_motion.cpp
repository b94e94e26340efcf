#include "frontends/str/expected_motion.hpp"

#include <Eigen/QR>

namespace evbench::str {

std::optional<Matrix3> expected_motion(const Feedback& feedback, MotionModel model) {
  constexpr std::size_t kLeast = 8;
  if (!feedback.newest || feedback.state != TrackingState::tracking || feedback.expected.size() < kLeast) {
    return std::nullopt;
  }
  const SE3 T_camera_world = feedback.newest->T.inverse();
  const Vector3 omega = feedback.newest->velocity.head<3>(), v = feedback.newest->velocity.tail<3>();
  const std::vector<Matrix3>& G = generators(model);
  const auto unknowns = static_cast<Eigen::Index>(G.size());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(unknowns);
  std::size_t seen = 0;
  for (const ExpectedFeature& feature : feedback.expected) {
    const Vector3 point = T_camera_world * feature.position;
    if (!(point.z() > 0.0) || !point.allFinite()) continue;
    const Vector3 ray = point / point.z();
    // d ray/dt = -A ray, up to its length; the point itself moves by -(ω × p + v).
    const auto in_image = [&](const Vector3& d) -> Vector2 { return d.head<2>() - d.z() * ray.head<2>(); };
    Eigen::MatrixXd J(2, unknowns);
    for (Eigen::Index k = 0; k < unknowns; ++k) J.col(k) = in_image(G[static_cast<std::size_t>(k)] * ray);
    H += J.transpose() * J;
    g += J.transpose() * in_image(omega.cross(ray) + v / point.z());
    ++seen;
  }
  if (seen < kLeast) return std::nullopt;
  const Matrix3 A = generator_matrix(model, H.colPivHouseholderQr().solve(g));
  return A.allFinite() ? std::optional(A) : std::nullopt;
}

}  // namespace evbench::str
