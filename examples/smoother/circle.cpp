// A camera flies a quarter of a circle around a wall of landmarks and sees each of them at its own times.
#include <cmath>
#include <cstdio>
#include <evbench/smoother.hpp>

using namespace evbench;
using namespace evbench::smoother;

int main() {
  const PinholeCamera camera{200.0, 200.0, 120.0, 90.0};  // fx, fy, cx, cy
  const auto pose = [](double t) { return se3::exp((Vector6() << 0.0, 0.8 * t, 0.0, -1.6 * t, 0.0, 0.0).finished()); };
  const Vector6 still = Vector6::Zero(), held = Vector6::Constant(1e-4), qc = Vector6::Constant(0.1);

  Smoother smoother(camera, qc, RobustLoss(RobustLoss::Kind::cauchy, 2.0));
  smoother.add_state({0.0, pose(0.0), still});
  smoother.add_pose_prior({0, pose(0.0), held});
  for (int j = 0; j < 30; ++j) {  // known to 10 cm, which gives the scale
    const Vector3 position(0.25 * (j % 6 - 2.5), 0.25 * (j / 6 - 2), 2.0);
    smoother.add_landmark(position + Vector3(0.05 * std::sin(j), 0.0, 0.05 * std::cos(j)), {position, 0.1});
  }
  for (int k = 1; k <= 40; ++k) {
    smoother.add_state_at(0.05 * k);  // [s], continues with constant velocity
    for (int j = 0; j < 30; ++j) {
      const double t = 0.05 * k - 0.001 * j;  // its own time
      const Vector3 point = pose(t).inverse() * Vector3(0.25 * (j % 6 - 2.5), 0.25 * (j / 6 - 2), 2.0);
      if (point.z() > 0.1) smoother.add_observation(j, {t, camera.project(point), 1.0 / 0.5});  // 1/sigma [1/px]
    }
    smoother.update();
  }
  const ControlState& newest = smoother.graph().states.back();
  const auto covariance = smoother.newest_covariance();
  std::printf("error %.4f m, sigma %.4f m\n", (newest.T.p - pose(newest.t).p).norm(),
              covariance ? std::sqrt(covariance->block<3, 3>(3, 3).trace()) : -1.0);
  return (newest.T.p - pose(newest.t).p).norm() < 0.05 ? 0 : 1;
}
