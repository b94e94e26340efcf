#pragma once

#include <vector>

#include "spline.hpp"

namespace spline_map {

/// Power spectral densities of the white noise that the camera's acceleration is taken for: how much the motion
/// changes.
struct MotionDensity {
  double rotation = 1.0;     ///< [rad²/s³]
  double translation = 1.0;  ///< [units²/s³]
};

/// The densities at each knot, learnt from the spline itself: no fixed ones serve slow and violent motion alike.
///
/// The mean of ‖acceleration‖² Δt an axis over the knots from `radius` seconds before to `radius` seconds after, and
/// not beyond t_end, where the spline is extrapolated; together with `expected`, which counts like `weight` knots: it
/// is what is believed before anything is seen, and keeps a calm stretch from forbidding any motion.
std::vector<MotionDensity> learn_densities(const Spline& spline, double t_end, double radius,
                                           const MotionDensity& expected, double weight);

}  // namespace spline_map
