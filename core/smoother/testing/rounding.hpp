#pragma once

#include <vector>

#include "core/smoother/factor_graph.hpp"

namespace evbench::smoother::testing {

/// Largest deviation of a state from the solution of its linear problem due to rounding alone.
struct RoundingBound {
  double position = 0.0;  ///< [m]
  double velocity = 0.0;  ///< [rad/s, m/s] norm of 6
};

/// Bounds for every state of the problem H δ = −g linearised at the graph's estimates, without a scale anchor. Infinite
/// if H is not positive definite as rounded.
///
/// A Cholesky factorisation in any order solves (H + E) δ' = −g with |E_ij| ≤ c u √(H_ii H_jj) (Demmel 1989; Higham,
/// Accuracy and Stability of Numerical Algorithms, section 10.1). With H = D K D, K of unit diagonal, and Σ = H⁻¹:
///
///   |δ'_i − δ_i| ≤ √Σ_ii ‖H^(−1/2) D‖ c u ‖D δ‖ ≤ σ_i c u ‖D δ‖ ‖K⁻¹‖^(1/2).
std::vector<RoundingBound> rounding_bounds(const FactorGraph& graph);

}  // namespace evbench::smoother::testing
