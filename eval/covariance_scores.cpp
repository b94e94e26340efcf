#include "eval/covariance_scores.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace evbench {

CovarianceScores score_covariances(std::span<const RelativePose> poses, const PoseTrajectory& ground_truth,
                                   double scale, double time_offset) {
  CovarianceScores scores;
  Vector6 units = Vector6::Ones();
  units.tail<3>().setConstant(scale);
  for (const RelativePose& pose : poses) {
    const std::optional<SE3> from = ground_truth.pose(pose.t0 + time_offset);
    const std::optional<SE3> to = ground_truth.pose(pose.t1 + time_offset);
    if (!from || !to) continue;
    // The order of Eigen's sums depends on the alignment of memory: a fixed place makes the digits reproducible.
    alignas(64) const Eigen::LLT<Matrix6> covariance(units.asDiagonal() * pose.covariance * units.asDiagonal());
    if (covariance.info() != Eigen::Success) {
      ++scores.singular;
      continue;
    }
    const SE3 estimate{pose.T.q, scale * pose.T.p};
    alignas(64) const Vector6 error = se3::log(estimate.inverse() * (from->inverse() * *to));
    alignas(64) const Vector6 whitened = covariance.matrixL().solve(error);
    ++scores.n;
    scores.nees += whitened.squaredNorm() / 6.0;
    for (std::size_t k = 0; k < 3; ++k) {
      scores.within[k] += (whitened.array().abs() <= static_cast<double>(k + 1)).cast<double>().mean();
    }
  }
  if (scores.n == 0) return scores;
  const auto n = static_cast<double>(scores.n);
  scores.nees /= n;
  for (double& share : scores.within) share /= n;
  return scores;
}

Json to_json(const CovarianceScores& scores) {
  const auto value = [&](double number) { return scores.n > 0 && std::isfinite(number) ? Json(number) : Json(); };
  return {{"n", scores.n},
          {"singular", scores.singular},
          {"nees", value(scores.nees)},
          {"within_1_sigma", value(scores.within[0])},
          {"within_2_sigma", value(scores.within[1])},
          {"within_3_sigma", value(scores.within[2])}};
}

}  // namespace evbench
