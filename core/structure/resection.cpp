#include "core/structure/resection.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <vector>

#include "core/geometry/solve_symmetric.hpp"
#include "core/support/median.hpp"

namespace evbench {

namespace {

double median_error(const SE3& T, std::span<const InversePoint> points, std::span<const Vector2> pixels,
                    const PinholeCamera& camera) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto error = image_error(T, points[i], pixels[i], camera);
    errors.push_back(error ? error->norm() : std::numeric_limits<double>::infinity());
  }
  return errors.empty() ? std::numeric_limits<double>::infinity() : median(std::move(errors));
}

}  // namespace

std::optional<Resection> resect(const SE3& guess, std::span<const InversePoint> points, std::span<const Vector2> pixels,
                                const PinholeCamera& camera, double width) {
  constexpr int kIterations = 15;
  constexpr std::size_t kFewest = 4;
  constexpr double kConverged = 1e-6, kDamping = 1e-9, kWide = 3.0;
  if (points.size() < kFewest) return std::nullopt;
  Resection result{guess, median_error(guess, points, pixels, camera)};
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    if (!std::isfinite(result.median_px)) return std::nullopt;
    const BoundedLoss loss{std::max(width, kWide * result.median_px)};
    Matrix6 H = Matrix6::Zero();
    Vector6 g = Vector6::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto image = point_image(result.T, points[i], pixels[i], camera);
      if (!image) continue;
      const double weight = loss.weight(image->error.squaredNorm());
      H += weight * image->pose.transpose() * image->pose;
      g += weight * image->pose.transpose() * image->error;
    }
    H.diagonal() *= 1.0 + kDamping;
    const Vector6 step = solve_symmetric(H, -g);
    if (!step.allFinite()) return std::nullopt;
    result.T = result.T * se3::exp(step);
    result.median_px = median_error(result.T, points, pixels, camera);
    if (step.norm() < kConverged) break;
  }
  return result;
}

}  // namespace evbench
