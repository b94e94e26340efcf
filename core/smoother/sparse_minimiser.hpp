#pragma once

#include <Eigen/CholmodSupport>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/smoother/batch_solver.hpp"

namespace evbench::smoother {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// Supernodal, of the lower triangle. A matrix that is not positive definite is a result here: no warning is printed.
struct SparseCholesky : Eigen::CholmodSupernodalLLT<SparseMatrix, Eigen::Lower> {
  SparseCholesky() { cholmod().print = 0; }
};

/// The normal equations H δ = −g, summed up block by block. Negative rows and columns belong to no variable: blocks
/// there are skipped.
class NormalEquations {
 public:
  explicit NormalEquations(int size) : gradient_(Eigen::VectorXd::Zero(size)) {}

  /// Adds to H at (row, column), and the transpose at (column, row); of a block on the diagonal the lower triangle
  /// counts.
  template <class Block>
  void add_block(int row, int column, const Block& block) {
    if (row < 0 || column < 0) return;
    if (row < column) {
      add_block(column, row, block.transpose().eval());
      return;
    }
    for (int c = 0; c < block.cols(); ++c) {
      for (int r = 0; r < block.rows(); ++r) {
        if (row + r >= column + c) triplets_.emplace_back(row + r, column + c, block(r, c));
      }
    }
  }

  template <class Segment>
  void add_gradient(int row, const Segment& segment) {
    if (row >= 0) gradient_.segment(row, segment.size()) += segment;
  }

  /// The lower triangle of H.
  SparseMatrix matrix() const {
    SparseMatrix H(gradient_.size(), gradient_.size());
    H.setFromTriplets(triplets_.begin(), triplets_.end());
    return H;
  }
  const Eigen::VectorXd& gradient() const { return gradient_; }

 private:
  std::vector<Eigen::Triplet<double>> triplets_;
  Eigen::VectorXd gradient_;
};

/// Levenberg-Marquardt. A problem has cost(), linearise() at its estimate, which returns NormalEquations of a constant
/// pattern, apply(δ), and estimate() with restore(), which undo it. The estimate never gets worse: steps that raise the
/// cost are undone.
template <class Problem>
BatchSummary minimise(Problem& problem, const BatchOptions& options) {
  BatchSummary summary;
  summary.initial_cost = summary.final_cost = problem.cost();
  SparseCholesky cholesky;
  bool analysed = false;
  double damping = 1e-6;  // relative to the diagonal
  constexpr double kMaxDamping = 1e8;
  constexpr double kLeastInformation = 1e-3;
  while (summary.iterations < options.max_iterations && !summary.converged) {
    const NormalEquations equations = problem.linearise();
    const SparseMatrix H = equations.matrix();
    if (!analysed) cholesky.analyzePattern(H);
    analysed = true;
    // The floor keeps an undetermined variable (a landmark behind every camera that saw it) from being singular.
    const Eigen::VectorXd diagonal = H.diagonal().cwiseMax(kLeastInformation);
    const auto before = problem.estimate();
    bool accepted = false;
    while (!accepted && damping < kMaxDamping) {
      SparseMatrix damped = H;
      damped.diagonal() += damping * diagonal;
      cholesky.factorize(damped);
      bool usable = cholesky.info() == Eigen::Success;
      if (usable) {
        const Eigen::VectorXd step = cholesky.solve(-equations.gradient());
        usable = step.allFinite();
        if (usable) problem.apply(step);
      }
      const double cost = usable ? problem.cost() : 0.0;
      accepted = usable && cost <= summary.final_cost;  // false for NaN
      if (accepted) {
        summary.converged = summary.final_cost - cost <= options.relative_tolerance * summary.final_cost;
        summary.final_cost = cost;
        damping = std::max(1e-12, damping * 0.1);
      } else {
        problem.restore(before);
        damping *= 10.0;
      }
    }
    ++summary.iterations;
    if (!accepted) {
      // No step lowers the cost: at a minimum to rounding, unless the system could not even be solved.
      summary.converged = cholesky.info() == Eigen::Success;
      if (!summary.converged) summary.failure = "the normal equations are singular";
      break;
    }
  }
  if (!std::isfinite(summary.final_cost)) summary.failure = "the cost is not finite";
  return summary;
}

}  // namespace evbench::smoother
