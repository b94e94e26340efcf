#include "core/structure/depth_reversal.hpp"

#include <algorithm>
#include <vector>

#include "core/geometry/so3.hpp"
#include "core/support/median.hpp"

namespace evbench {

InitialGuess reverse_depth(const InitialGuess& guess) {
  InitialGuess result = guess;
  const Vector3& p = guess.T1.p;
  result.T1.q = so3::exp(so3::log(guess.T1.q) + 2.0 * Vector3(-p.y(), p.x(), 0.0));
  result.T1.p = Vector3(-p.x(), -p.y(), p.z());
  std::vector<double> depths;
  for (Landmark& landmark : result.landmarks) {
    const Vector3 ray = landmark.position / landmark.position.z();
    const double inverse_depth = std::clamp(2.0 - 1.0 / landmark.position.z(), 0.2, 2.0);
    landmark.position = ray / inverse_depth;
    depths.push_back(1.0 / inverse_depth);
  }
  if (depths.empty()) return result;
  const double depth = median(std::move(depths));
  for (Landmark& landmark : result.landmarks) landmark.position /= depth;
  result.T1.p /= depth;
  return result;
}

bool same_motion(const SE3& a, const SE3& b) {
  const double angle = so3::log(a.q.conjugate() * b.q).norm();
  return angle < 0.5 / kDegrees && (a.p - b.p).norm() < 0.05 * std::max(a.p.norm(), b.p.norm());
}

}  // namespace evbench
