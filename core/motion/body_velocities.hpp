#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/geometry/types.hpp"

namespace evbench {

struct StampedVelocity {
  double t = 0.0;                      ///< [s]
  Vector6 velocity = Vector6::Zero();  ///< of the body: (ω [rad/s], ν [m/s])
};

/// The body velocities that an estimate states.
class BodyVelocities {
 public:
  BodyVelocities() = default;

  /// `velocities` at strictly rising times.
  explicit BodyVelocities(std::vector<StampedVelocity> velocities) : velocities_(std::move(velocities)) {}

  const std::vector<StampedVelocity>& all() const { return velocities_; }
  bool empty() const { return velocities_.empty(); }

  /// At t, linearly between neighbours that are at most 0.25 s apart; none elsewhere.
  std::optional<Vector6> at(double t) const;

 private:
  std::vector<StampedVelocity> velocities_;
};

}  // namespace evbench
