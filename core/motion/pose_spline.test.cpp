#include "core/motion/pose_spline.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/so3.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

/// A motion with rotation and translation in all directions.
SE3 truth(double t) {
  return SE3{so3::exp({0.8 * std::sin(1.3 * t), 0.5 * std::cos(1.7 * t), 0.9 * std::sin(0.7 * t + 1.0)}),
             {std::sin(t), 0.5 * std::cos(1.9 * t), 0.3 * std::sin(2.3 * t)}};
}

/// Poses of this motion at uneven times, about `step` [s] apart.
std::vector<StampedPose> poses(double step) {
  std::vector<StampedPose> result;
  for (double t = 0.0; t < 5.0; t += step * (1.0 + 0.4 * std::sin(7.0 * t))) result.push_back({t, truth(t)});
  return result;
}

Vector6 velocity(const PoseSpline& spline, double t) {
  const double h = 1e-4;
  return se3::log(spline.at(t - h).inverse() * spline.at(t + h)) / (2.0 * h);
}

Vector6 acceleration(const PoseSpline& spline, double t) {
  const double h = 1e-4;
  return (velocity(spline, t + h) - velocity(spline, t - h)) / (2.0 * h);
}

double largest_error(double step) {
  const PoseSpline spline(PoseTrajectory(poses(step)));
  double largest = 0.0;
  for (double t = 0.5; t < 4.5; t += 0.0113) {
    largest = std::max(largest, se3::log(truth(t).inverse() * spline.at(t)).norm());
  }
  return largest;
}

}  // namespace

TEST_CASE("A pose spline passes through its poses") {
  const std::vector<StampedPose> given = poses(0.1);
  const PoseSpline spline{PoseTrajectory(given)};
  for (const StampedPose& pose : given) CHECK(se3::log(pose.T.inverse() * spline.at(pose.t)).norm() < 1e-12);
}

TEST_CASE("Velocity and acceleration of a pose spline are continuous at its poses, in rotation and translation") {
  const std::vector<StampedPose> given = poses(0.1);
  const PoseSpline spline{PoseTrajectory(given)};
  double largest = 0.0;
  for (std::size_t i = 1; i + 1 < given.size(); ++i) {
    const double t = given[i].t;
    // A discontinuity stays as the distance shrinks; a continuous change does not.
    const auto change = [&](const auto& rate, double near) {
      return Vector6(rate(spline, t + near) - rate(spline, t - near));
    };
    CHECK(change(velocity, 1e-3).norm() < 0.02);
    const Vector6 far = change(acceleration, 4e-3), near = change(acceleration, 1e-3);
    CHECK(near.head<3>().norm() < 0.05 + 0.5 * far.head<3>().norm());
    CHECK(near.tail<3>().norm() < 0.05 + 0.5 * far.tail<3>().norm());
    largest = std::max(largest, acceleration(spline, t).norm());
  }
  CHECK(largest > 2.0);  // the velocity does change
}

TEST_CASE("A pose spline converges to a smooth motion with the third power of the poses' spacing") {
  const double coarse = largest_error(0.1), fine = largest_error(0.05);
  CHECK(coarse < 1e-3);
  CHECK(fine < coarse / 6.0);
}

TEST_CASE("A pose spline of two poses is a constant velocity, and of one pose constant") {
  const SE3 A = truth(0.0), B = truth(0.2);
  const PoseSpline line(PoseTrajectory({{1.0, A}, {3.0, B}}));
  CHECK(se3::log(B.inverse() * line.at(3.0)).norm() < 1e-12);
  CHECK((velocity(line, 1.5) - velocity(line, 2.5)).norm() < 1e-9);
  const PoseSpline rest(PoseTrajectory({{1.0, A}}));
  CHECK(se3::log(A.inverse() * rest.at(7.0)).norm() < 1e-12);
}
