#include "core/motion/body_velocities.hpp"

#include <algorithm>
#include <iterator>

namespace evbench {

std::optional<Vector6> BodyVelocities::at(double t) const {
  constexpr double kFarthest = 0.25;  // [s]
  const auto right = std::ranges::lower_bound(velocities_, t, {}, &StampedVelocity::t);
  if (right == velocities_.end()) return std::nullopt;
  if (right->t == t) return right->velocity;
  if (right == velocities_.begin()) return std::nullopt;
  const StampedVelocity& left = *std::prev(right);
  if (right->t - left.t > kFarthest) return std::nullopt;
  const double share = (t - left.t) / (right->t - left.t);
  return Vector6((1.0 - share) * left.velocity + share * right->velocity);
}

}  // namespace evbench
