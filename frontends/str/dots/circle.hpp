#pragma once

#include <optional>
#include <span>

#include "core/geometry/types.hpp"

namespace evbench::str {

struct Circle {
  Vector2 centre = Vector2::Zero();  ///< [px]
  double radius = 0.0;               ///< [px]
};

/// A circle through points and how well they lie on it.
struct CircleFit {
  Circle circle;
  double residual = 0.0;  ///< [px] root mean square of the distances from the rim
  double covered = 0.0;   ///< share of eight equal sectors of the rim on which at least a sixteenth of the points lies
};

/// Fits a circle to at least eight points: least squares of the algebraic distances (Kåsa 1976), then of the distances
/// from the rim. None where the points do not determine a circle.
std::optional<CircleFit> fit_circle(std::span<const Vector2> points);

}  // namespace evbench::str
