#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

#include "core/smoother/batch_solver.hpp"
#include "core/support/index.hpp"

namespace evbench::smoother::testing {

/// The largest difference over all control states between an estimate and the batch solver's optimum, in standard
/// deviations: of one component of the state, and whitened by its covariance (a norm).
struct OracleDistance {
  double component = 0.0;
  double whitened = 0.0;
};

/// The oracle starts from the estimate and runs to convergence. Standard deviations are computed for every n-th state,
/// because this takes long in large problems, and used up to the next one: they change slowly. Infinite if the oracle
/// fails.
inline OracleDistance distance_from_oracle(const FactorGraph& estimate, int every = 1) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  FactorGraph optimum = estimate;
  if (!solve_batch(optimum, {.max_iterations = 50, .relative_tolerance = 1e-13}).failure.empty()) {
    return {kInfinite, kInfinite};
  }
  const BatchCovariance covariance(optimum);
  OracleDistance distance;
  const int newest = static_cast<int>(optimum.states.size()) - 1;
  const int n = optimum.state_size();
  StateMatrix own = StateMatrix::Identity(n, n);
  for (int k = 0; k <= newest; ++k) {
    if (k % every == 0) {
      const auto joint = covariance.neighbours(std::min(k, newest - 1));
      if (!joint) return {kInfinite, kInfinite};
      own = k < newest ? joint->topLeftCorner(n, n) : joint->bottomRightCorner(n, n);
    }
    const ControlState& a = optimum.states[index(k)];
    const ControlState& b = estimate.states[index(k)];
    StateVector apart(n);
    apart.head<12>() << se3::log(a.T.inverse() * b.T), b.velocity - a.velocity;
    if (n == 18) apart.tail<6>() = b.acceleration - a.acceleration;
    distance.component =
        std::max(distance.component, apart.cwiseAbs().cwiseQuotient(own.diagonal().cwiseSqrt()).maxCoeff());
    distance.whitened = std::max(distance.whitened, own.llt().matrixL().solve(apart).norm());
  }
  return distance;
}

}  // namespace evbench::smoother::testing
