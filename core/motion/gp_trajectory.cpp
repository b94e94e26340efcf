#include "core/motion/gp_trajectory.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/support/error.hpp"

namespace evbench {

GpTrajectory::GpTrajectory(std::vector<ControlState> states) : states_(std::move(states)) {
  for (std::size_t i = 1; i < states_.size(); ++i) {
    if (!(states_[i - 1].t < states_[i].t)) {
      throw InputError(fmt::format("control state {} has time {:.9f} s, not after the one before it ({:.9f} s)", i,
                                   states_[i].t, states_[i - 1].t));
    }
  }
}

ControlState GpTrajectory::at(double t) const {
  if (t <= start()) return extrapolate(states_.front(), t - start());
  if (t >= end()) return extrapolate(states_.back(), t - end());
  const auto right = std::upper_bound(states_.begin(), states_.end(), t,
                                      [](double time, const ControlState& state) { return time < state.t; });
  const GpInterval interval(*(right - 1), *right);
  return {t, interval.pose(t), interval.velocity(t)};
}

ControlState extrapolate(const ControlState& state, double dt) {
  return {state.t + dt, state.T * se3::exp(dt * state.velocity), state.velocity};
}

}  // namespace evbench
