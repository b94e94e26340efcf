#include "eval/latency.hpp"

#include "core/testing/catch2.hpp"
#include "eval/testing/trajectories.hpp"

namespace evbench {
namespace {

using testing::wavy_pose;

/// Motion along x at 1 m/s.
SE3 straight(double t) { return {Eigen::Quaterniond::Identity(), {t, 0.0, 0.0}}; }

std::vector<double> grid(double from, double to, double step = 0.01) {
  std::vector<double> times;
  for (int i = 0; from + i * step <= to + 1e-9; ++i) times.push_back(from + i * step);
  return times;
}

double x_at(const PoseTrajectory& trajectory, double t) { return trajectory.pose(t).value().p.x(); }

}  // namespace

TEST_CASE("At zero latency a pose counts once it is known, and before that it is predicted by constant velocity") {
  // Batches of 0.2 s: a pose in the middle of each is known 0.1 s later. From 1 s on the camera is stationary.
  std::vector<CausalPose> published;
  for (int i = 0; i < 10; ++i) {
    const double t = 0.1 + 0.2 * i;
    published.push_back({{t, straight(std::min(t, 1.0))}, t + 0.1});
  }
  const PoseTrajectory at_once = estimates_at_latency(published, grid(0.0, 2.0), 0.0);
  CHECK(at_once.start() == Approx(0.2));     // when the first pose is known
  CHECK(x_at(at_once, 0.3) == Approx(0.1));  // one pose has no velocity
  CHECK(x_at(at_once, 0.5) == Approx(0.5));
  CHECK(x_at(at_once, 1.19) == Approx(1.19));  // the stationary camera is not known yet
  CHECK(x_at(at_once, 1.2) == Approx(0.9 + 0.3 * 0.5));
  CHECK(x_at(at_once, 1.9) == Approx(1.0));
}

TEST_CASE("With a latency later poses and improved estimates count, but not before they are known") {
  std::vector<CausalPose> published;
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.02 * i;
    published.push_back({{t, {Eigen::Quaterniond::Identity(), {0.0, 1.0, 0.0}}}, t});  // rough
    if (i >= 5) published.push_back({{0.02 * (i - 5), straight(0.02 * (i - 5))}, t});  // smoothed
  }
  const auto rough = [&](const PoseTrajectory& poses, double t) { return poses.pose(t)->p.y() > 0.5; };
  CHECK(rough(estimates_at_latency(published, grid(0.0, 1.8), 0.0), 1.0));
  CHECK(rough(estimates_at_latency(published, grid(0.0, 1.8), 0.08), 1.0));
  const PoseTrajectory smoothed = estimates_at_latency(published, grid(0.0, 1.8), 0.12);
  for (const StampedPose& pose : smoothed.poses()) CHECK(pose.T.p.x() == Approx(pose.t).margin(1e-9));
}

TEST_CASE("With enough latency nothing is predicted, and interpolation is that of PoseTrajectory") {
  std::vector<CausalPose> published;
  std::vector<StampedPose> poses;
  for (double t = 0.0; t < 2.0; t += 0.05) {
    published.push_back({{t, wavy_pose(t)}, t + 0.03});
    poses.push_back(published.back());
  }
  const PoseTrajectory own(poses), late = estimates_at_latency(published, grid(0.01, 1.9), 0.2);
  REQUIRE(late.size() == 190);
  for (const StampedPose& pose : late.poses()) {
    CHECK(se3::log(own.pose(pose.t)->inverse() * pose.T).norm() < 1e-12);
  }
}

TEST_CASE("Predictions use the published velocity if there is one, and end after a second") {
  const Vector6 velocity = (Vector6() << 0, 0, 0, 3, 0, 0).finished();
  const std::vector<CausalPose> published = {{{0.0, straight(0.0)}, 0.0}, {{0.5, straight(0.5)}, 0.5, velocity}};
  const PoseTrajectory poses = estimates_at_latency(published, grid(0.0, 4.0), 0.0);
  CHECK(x_at(poses, 0.4) == Approx(0.0));
  CHECK(x_at(poses, 1.0) == Approx(0.5 + 3.0 * 0.5));
  CHECK(poses.end() == Approx(1.5));
  CHECK(estimates_at_latency({}, grid(0.0, 1.0), 0.0).empty());
  // Poses very close in time do not determine a velocity.
  const std::vector<CausalPose> dense = {
      {{0.0, straight(0.0)}, 0.0}, {{0.1, straight(0.1)}, 0.1}, {{0.1 + 1e-6, straight(0.11)}, 0.1 + 1e-6}};
  CHECK(x_at(estimates_at_latency(dense, grid(0.0, 0.5), 0.0), 0.5) == Approx(0.11 + 0.4 * 1.1).epsilon(1e-3));
}

}  // namespace evbench
