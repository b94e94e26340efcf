#pragma once

#include <vector>

#include "spline.hpp"

namespace spline_map {

/// Power spectral densities of the camera's acceleration, modelled as white noise: how much the motion changes.
struct MotionDensity {
  double rotation = 1.0;     ///< [rad²/s³]
  double translation = 1.0;  ///< [units²/s³]
};

/// Estimates the densities at each knot from the spline itself, because no fixed values suit both slow and aggressive
/// motion.
///
/// A density is the mean of ‖acceleration‖² Δt per axis over the knots within `radius` seconds, but not beyond t_end,
/// where the spline is extrapolated. `expected` counts like `weight` knots: it is the prior before any data, and keeps
/// a slow period from suppressing all motion.
std::vector<MotionDensity> estimate_densities(const Spline& spline, double t_end, double radius,
                                              const MotionDensity& expected, double weight);

}  // namespace spline_map
