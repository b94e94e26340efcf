#include "frontends/haste/tracking/change.hpp"

namespace evbench::haste {

namespace {

/// a + b_x x + b_y y + (c x² + 2 d x y + e y²) / 2 through the scores of the null hypothesis and its eight neighbours;
/// on this grid the least-squares solution falls apart into differences.
struct Paraboloid {
  double b_x = 0.0, b_y = 0.0, c, d = 0.0, e;

  explicit Paraboloid(const Scores& scores) {
    double column[3] = {}, row[3] = {};
    for (std::size_t h = 0; h < kHypotheses; ++h) {
      const auto [x, y, angle] = kSteps[h];
      if (angle != 0) continue;
      const double f = scores.of[h];
      b_x += x * f / 6.0;
      b_y += y * f / 6.0;
      d += x * y * f / 4.0;
      column[x + 1] += f / 3.0;
      row[y + 1] += f / 3.0;
    }
    c = column[0] - 2.0 * column[1] + column[2];
    e = row[0] - 2.0 * row[1] + row[2];
  }
};

}  // namespace

double Scores::weakest_curvature() const {
  const Paraboloid f(*this);
  const double largest = std::max(std::abs(best()), std::abs(worst()));
  return largest > 0.0 ? -(0.5 * (f.c + f.e) + std::hypot(0.5 * (f.c - f.e), f.d)) / largest : 0.0;
}

std::optional<Matrix2> Scores::flatness() const {
  const Paraboloid f(*this);
  const double determinant = f.c * f.e - f.d * f.d, largest = std::max(std::abs(best()), std::abs(worst()));
  if (!(f.c < 0.0 && determinant > 0.0)) return std::nullopt;
  return Matrix2({{-f.e, f.d}, {f.d, -f.c}}) * (largest / determinant);
}

Vector2 refined_position(const Change& change) {
  const auto [b_x, b_y, c, d, e] = Paraboloid(change.scores);
  const double determinant = c * e - d * d;
  if (!(c < 0.0 && determinant > 0.0)) return midpoint(change);
  const Vector2 peak((d * b_y - e * b_x) / determinant, (d * b_x - c * b_y) / determinant);
  return change.before.position + peak.cwiseMax(-1.0).cwiseMin(1.0);
}

}  // namespace evbench::haste
