#include "eval/covariance_scores.hpp"

#include <Eigen/Cholesky>
#include <random>

#include "core/testing/catch2.hpp"
#include "eval/testing/trajectories.hpp"

namespace evbench {
namespace {

constexpr double kScale = 2.5;  // metres in the estimate's unit

/// Relative poses over 0.1 s, in the estimate's unit, with errors drawn from a covariance. The stated covariance is
/// `factor` times as large.
std::vector<RelativePose> drawn(const PoseTrajectory& truth, double factor, int count = 2000) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::vector<RelativePose> poses;
  for (int i = 0; i < count; ++i) {
    Matrix6 L = Matrix6::Zero();
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < row; ++column) L(row, column) = 0.003 * std::sin(1.0 + row + 3.0 * column);
      L(row, row) = 0.01 * (1.0 + row);
    }
    Vector6 noise;
    for (double& x : noise) x = normal(random);
    const double t0 = 0.002 * i, t1 = t0 + 0.1;
    SE3 metric = truth.pose(t0)->inverse() * *truth.pose(t1) * se3::exp(-L * noise);
    metric.p /= kScale;
    Vector6 units = Vector6::Ones();
    units.tail<3>().setConstant(1.0 / kScale);
    poses.push_back(
        {"over_100ms", t0, t1, metric, factor * (units.asDiagonal() * L * L.transpose() * units.asDiagonal())});
  }
  return poses;
}

}  // namespace

TEST_CASE("Errors that agree with their covariances have NEES one, in any unit of the estimate") {
  const PoseTrajectory truth = testing::sample(testing::wavy_pose, 500);
  const CovarianceScores scores = score_covariances(drawn(truth, 1.0), truth, kScale, 0.0);
  CHECK(scores.n == 2000);
  CHECK(scores.singular == 0);
  CHECK(scores.nees == Approx(1.0).epsilon(0.05));
  CHECK(scores.within[0] == Approx(0.683).margin(0.02));
  CHECK(scores.within[1] == Approx(0.954).margin(0.01));
  CHECK(scores.within[2] == Approx(0.997).margin(0.004));
  CHECK(score_covariances(drawn(truth, 1.0), truth, 1.0, 0.0).nees > 1.5);  // the scale is missing
}

TEST_CASE("Overconfident covariances have a larger NEES, and singular ones are counted") {
  const PoseTrajectory truth = testing::sample(testing::wavy_pose, 500);
  const CovarianceScores overconfident = score_covariances(drawn(truth, 0.25), truth, kScale, 0.0);
  CHECK(overconfident.nees == Approx(4.0).epsilon(0.05));
  CHECK(overconfident.within[0] < 0.4);
  std::vector<RelativePose> poses = drawn(truth, 1.0, 10);
  poses[3].covariance.setZero();
  poses[4].t1 = 100.0;  // no ground truth there
  const CovarianceScores some = score_covariances(poses, truth, kScale, 0.0);
  CHECK(some.n == 8);
  CHECK(some.singular == 1);
  const Json none = to_json(score_covariances({}, truth, kScale, 0.0));
  CHECK(none.at("n") == 0);
  CHECK(none.at("nees").is_null());
}

}  // namespace evbench
