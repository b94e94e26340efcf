#include "frontends/str/dots/circle.hpp"

#include <Eigen/QR>
#include <array>
#include <cmath>

#include "core/geometry/solve_symmetric.hpp"

namespace evbench::str {

std::optional<CircleFit> fit_circle(std::span<const Vector2> points) {
  constexpr std::size_t kLeast = 8;
  constexpr int kSteps = 5;
  if (points.size() < kLeast) return std::nullopt;
  Vector2 mean = Vector2::Zero();
  for (const Vector2& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  // 2 a x + 2 b y + c = x² + y², the centre (a, b), c = r² - a² - b².
  Matrix3 H = Matrix3::Zero();
  Vector3 g = Vector3::Zero();
  for (const Vector2& p : points) {
    const Vector2 d = p - mean;
    const Vector3 row(2.0 * d.x(), 2.0 * d.y(), 1.0);
    H += row * row.transpose();
    g += d.squaredNorm() * row;
  }
  const Vector3 algebraic = H.colPivHouseholderQr().solve(g);
  Vector2 centre = algebraic.head<2>();
  double radius = std::sqrt(std::max(0.0, algebraic.z() + centre.squaredNorm()));
  for (int step = 0; step < kSteps; ++step) {
    H.setZero();
    g.setZero();
    for (const Vector2& p : points) {
      const Vector2 d = p - mean - centre;
      const double distance = d.norm();
      if (!(distance > 0.0)) continue;
      const Vector3 J(-d.x() / distance, -d.y() / distance, -1.0);
      H += J * J.transpose();
      g += (distance - radius) * J;
    }
    H.diagonal().array() += 1e-9;
    const Vector3 change = solve_symmetric(H, -g);
    centre += change.head<2>();
    radius += change.z();
  }
  CircleFit result{{mean + centre, radius}, 0.0, 0.0};
  if (!centre.allFinite() || !(radius > 0.0) || !std::isfinite(radius)) return std::nullopt;
  constexpr std::size_t kSectors = 8;
  std::array<std::size_t, kSectors> sectors{};
  double squares = 0.0;
  for (const Vector2& p : points) {
    const Vector2 d = p - result.circle.centre;
    squares += (d.norm() - radius) * (d.norm() - radius);
    const double turn = (std::atan2(d.y(), d.x()) + M_PI) / (2.0 * M_PI);
    ++sectors[std::min(kSectors - 1, static_cast<std::size_t>(turn * kSectors))];
  }
  result.residual = std::sqrt(squares / static_cast<double>(points.size()));
  for (const std::size_t count : sectors) result.covered += 16 * count >= points.size() ? 1.0 / kSectors : 0.0;
  return result;
}

}  // namespace evbench::str
