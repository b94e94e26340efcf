#include "core/smoother/robust_loss.hpp"

namespace evbench::smoother {

/// With ψ(r) = w r of residuals r ~ N(0, I): the weights state the information E[w], the estimate has E[∇·ψ/2]² /
/// E[|ψ|²/2], and E[∇·ψ] = E[ψ·r] (Stein). Integrated over the norm of r by the midpoint rule.
double RobustLoss::information_share() const {
  constexpr int kSteps = 1000;
  constexpr double kFarthest = 10.0, kStep = kFarthest / kSteps;
  double w = 0.0, w_s = 0.0, w2_s = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double norm = (i + 0.5) * kStep, s = norm * norm;
    const double probability = kStep * norm * std::exp(-0.5 * s), slope_here = slope(s);
    w += probability * slope_here;
    w_s += probability * slope_here * s;
    w2_s += probability * slope_here * slope_here * s;
  }
  return 2.0 * w * w2_s / (w_s * w_s);
}

}  // namespace evbench::smoother
