#include "frontends/haste/tracking/score_noise.hpp"

#include <Eigen/Eigenvalues>

namespace evbench::haste {

PixelNoise ScoreNoise::next(const Scores& scores) {
  constexpr double kLeast = 0.5, kMost = 3.0;  // times the usual one
  constexpr double kPace = 0.01;               // by which an observation moves the median, up or down
  const std::optional<Matrix2> flatness = scores.flatness();
  if (!flatness) return kMost * usual_;
  const double mean = 0.5 * flatness->trace();
  if (flatness_ == 0.0) flatness_ = mean;
  Eigen::SelfAdjointEigenSolver<Matrix2> solver;
  solver.computeDirect(*flatness / flatness_);
  flatness_ *= mean > flatness_ ? 1.0 + kPace : 1.0 / (1.0 + kPace);
  const Vector2 sigma = usual_ * solver.eigenvalues().cwiseMax(kLeast).cwiseMin(kMost);
  return PixelNoise(1.0).mapped(solver.eigenvectors() * sigma.asDiagonal());
}

}  // namespace evbench::haste
