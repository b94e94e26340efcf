#include "core/motion/wnoa.hpp"

namespace evbench::wnoa {
namespace {

Matrix12 blocks(double pose, double cross, double velocity, const Vector6& diagonal) {
  Matrix12 m = Matrix12::Zero();
  m.diagonal() << pose * diagonal, velocity * diagonal;
  m.topRightCorner<6, 6>().diagonal() = cross * diagonal;
  m.bottomLeftCorner<6, 6>().diagonal() = cross * diagonal;
  return m;
}

}  // namespace

Matrix12 process_covariance(double dt, const Vector6& qc) { return blocks(dt * dt * dt / 3.0, 0.5 * dt * dt, dt, qc); }

Matrix12 process_information(double dt, const Vector6& qc) {
  return blocks(12.0 / (dt * dt * dt), -6.0 / (dt * dt), 4.0 / dt, qc.cwiseInverse());
}

Matrix12 transition(double dt) {
  Matrix12 m = Matrix12::Identity();
  m.topRightCorner<6, 6>().diagonal().setConstant(dt);
  return m;
}

}  // namespace evbench::wnoa
