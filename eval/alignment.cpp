#include "eval/alignment.hpp"

#include <cmath>

#include "core/geometry/nearest_rotation.hpp"
#include "core/support/index.hpp"

namespace evbench {
namespace {

constexpr double kDegenerate = 1e-12;  // relative to the product of the spreads: 1e-6 in each trajectory's size

/// First and second moments of the positions; orientations for what positions do not determine.
struct Moments {
  Vector3 mean_truth = Vector3::Zero(), mean_estimate = Vector3::Zero();
  double variance_truth = 0.0, variance_estimate = 0.0;
  Matrix3 covariance = Matrix3::Zero();  ///< mean of (p_truth − mean)(p_estimate − mean)ᵀ
  Matrix3 rotations = Matrix3::Zero();   ///< Σ R_truth R_estimateᵀ
};

Moments moments(std::span<const PosePair> pairs) {
  Moments m;
  const double weight = 1.0 / static_cast<double>(pairs.size());
  for (const PosePair& pair : pairs) {
    m.mean_truth += weight * pair.ground_truth.p;
    m.mean_estimate += weight * pair.estimate.p;
  }
  for (const PosePair& pair : pairs) {
    const Vector3 truth = pair.ground_truth.p - m.mean_truth;
    const Vector3 estimate = pair.estimate.p - m.mean_estimate;
    m.variance_truth += weight * truth.squaredNorm();
    m.variance_estimate += weight * estimate.squaredNorm();
    m.covariance += weight * truth * estimate.transpose();
    m.rotations += (pair.ground_truth.q * pair.estimate.q.conjugate()).toRotationMatrix();
  }
  return m;
}

bool is_stationary(double variance, const Vector3& mean) {
  const double rounding = 1e-9 * (1.0 + mean.norm());
  return variance <= rounding * rounding;
}

/// Angle θ with the largest tr(Rot(axis, θ)ᵀ M).
double best_angle(const Vector3& axis, const Matrix3& M) {
  const Vector3 skew(M(2, 1) - M(1, 2), M(0, 2) - M(2, 0), M(1, 0) - M(0, 1));
  return std::atan2(axis.dot(skew), M.trace() - axis.dot(M * axis));
}

Matrix3 rotation_about(const Vector3& axis, double angle) { return Eigen::AngleAxisd(angle, axis).toRotationMatrix(); }

Similarity through_means(const Moments& m, const Matrix3& R, double scale) {
  return {scale, {Eigen::Quaterniond(R), m.mean_truth - scale * R * m.mean_estimate}};
}

Alignment align_yaw(const Moments& m) {
  const Vector3 z = Vector3::UnitZ();
  const Matrix3& C = m.covariance;
  const double determined = std::hypot(C(1, 0) - C(0, 1), C(0, 0) + C(1, 1));
  const bool open = determined <= kDegenerate * std::sqrt(m.variance_truth * m.variance_estimate) ||
                    is_stationary(m.variance_truth, m.mean_truth) ||
                    is_stationary(m.variance_estimate, m.mean_estimate);
  return {through_means(m, rotation_about(z, best_angle(z, open ? m.rotations : C)), 1.0),
          open ? "no horizontal motion: the yaw is from orientations" : ""};
}

Alignment align_stationary(const Moments& m, AlignmentMethod method, const char* who) {
  const std::string note = fmt::format("the {} is stationary: ", who);
  if (method == AlignmentMethod::scale) return {{}, note + "the scale is not determined and left at 1"};
  const bool with_scale = method == AlignmentMethod::sim3;
  return {through_means(m, nearest_rotation(m.rotations).R, 1.0),
          note + (with_scale ? "the scale is not determined and left at 1, the rotation is from orientations"
                             : "the rotation is from orientations")};
}

/// Umeyama 1991, eq. 40 to 42.
Alignment align_umeyama(const Moments& m, AlignmentMethod method) {
  NearestRotation best = nearest_rotation(m.covariance);
  const double scale = method == AlignmentMethod::se3 ? 1.0 : best.trace / m.variance_estimate;
  if (method == AlignmentMethod::scale) return {{scale, SE3{}}, ""};
  if (best.values[1] > kDegenerate * std::sqrt(m.variance_truth * m.variance_estimate)) {
    return {through_means(m, best.R, scale), ""};
  }
  const Matrix3 R =
      best.R * rotation_about(best.direction, best_angle(best.direction, best.R.transpose() * m.rotations));
  return {through_means(m, R, scale), "all positions lie on a line: the rotation about it is from orientations"};
}

}  // namespace

Alignment align(std::span<const PosePair> pairs, AlignmentMethod method) {
  if (method == AlignmentMethod::none) return {};
  const std::size_t needed = method == AlignmentMethod::origin ? 1 : 3;
  if (pairs.size() < needed) {
    throw InputError(fmt::format("{} pairs of poses to align on; {} alignment needs at least {}", pairs.size(),
                                 kAlignmentNames[index(method)], needed));
  }
  if (method == AlignmentMethod::origin) {
    return {{1.0, pairs.front().ground_truth * pairs.front().estimate.inverse()}, ""};
  }
  const Moments m = moments(pairs);
  if (method == AlignmentMethod::yaw) return align_yaw(m);
  if (is_stationary(m.variance_estimate, m.mean_estimate)) return align_stationary(m, method, "estimate");
  if (is_stationary(m.variance_truth, m.mean_truth)) return align_stationary(m, method, "ground truth");
  return align_umeyama(m, method);
}

Eigen::Quaterniond common_rotation(std::span<const PosePair> pairs) {
  return Eigen::Quaterniond(nearest_rotation(moments(pairs).rotations).R);
}

}  // namespace evbench
