#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/smoother/factor_graph.hpp"

namespace evbench::smoother {

struct BatchOptions {
  int max_iterations = 20;
  double relative_tolerance = 1e-8;  ///< stop when an accepted step lowers the cost by less than this share
};

struct BatchSummary {
  double initial_cost = 0.0, final_cost = 0.0;
  int iterations = 0;
  bool converged = false;
  std::string failure;  ///< empty unless the system could not be solved or is not finite
};

/// Levenberg-Marquardt over the problem's states and landmarks with a supernodal sparse Cholesky factorisation
/// (CHOLMOD) of the normal equations. It is the reference for incremental solvers. The estimate never gets worse: steps
/// that raise the cost are undone.
BatchSummary solve_batch(FactorGraph& graph, const BatchOptions& options);

/// Marginal covariances at the present estimate (Gauss-Newton approximation, increments on the right).
class BatchCovariance {
 public:
  explicit BatchCovariance(const FactorGraph& graph);
  ~BatchCovariance();

  /// Joint covariance of states k and k + 1, 24 × 24 (36 × 36 with Singer's prior); none if the information matrix is
  /// singular.
  std::optional<PairMatrix> neighbours(int k) const;

  /// Joint covariance of the poses of states i and j.
  std::optional<Matrix12> poses(int i, int j) const;

  /// Covariance of pose and velocity at any time within the states' span, in the gauge of the priors: the uncertainty
  /// of both neighbours plus the interpolation uncertainty of the prior.
  std::optional<Matrix12> at(double t) const;

  std::optional<Matrix3> landmark(int landmark) const;

 private:
  struct Factor;
  const FactorGraph& graph_;
  std::unique_ptr<Factor> factor_;
};

}  // namespace evbench::smoother
