#pragma once

#include <optional>
#include <vector>

#include "core/smoother/graph_variables.hpp"

namespace evbench {

/// Offsets in the image that the observations of one landmark have in common for a time, as unknowns.
struct DriftModel {
  double sigma = 0.0;   ///< of an offset, an axis [sigmas that observations state]; 0: there are none
  double window = 0.1;  ///< for which an offset holds [s]; infinite: for all of a track; 0: for one observation
  double time = 0.0;    ///< offsets Δt apart, from middle to middle, correlate by exp(−Δt/time) [s]; 0: not at all
};

/// A graph's problem in which each observation is z = π(T(t)⁻¹ l) + σ (o + e): e is noise under the graph's loss,
/// o the offset of the landmark's track in the window that holds t, a Gauss-Markov chain by DriftModel.
class DriftProblem {
 public:
  DriftProblem(smoother::FactorGraph graph, const DriftModel& model);

  /// By minimise(), from the graph's estimate and offsets of zero.
  smoother::BatchSummary solve(const smoother::BatchOptions& options);

  /// With the estimate; the offsets are taken from its observations.
  const smoother::FactorGraph& graph() const { return graph_; }
  const smoother::GraphLayout& layout() const { return layout_; }
  int unknowns() const { return layout_.size + 2 * static_cast<int>(offsets_.size()); }

  // The interface that minimise() needs.
  struct Estimate {
    smoother::GraphEstimate graph;
    std::vector<Vector2> offsets;
  };
  double cost() const;
  smoother::NormalEquations linearise() const;
  void apply(const Eigen::VectorXd& step);
  Estimate estimate() const { return {smoother::GraphEstimate(graph_), offsets_}; }
  void restore(const Estimate& estimate);

 private:
  /// An offset is Gaussian about `kept` of the one before: −1, none is.
  struct Link {
    int before = -1;
    double kept = 0.0;
    double information = 0.0;
  };

  int column(int offset) const { return layout_.size + 2 * offset; }
  Vector2 innovation(int offset) const;
  void take_offsets_away();
  void add_interval(int k, smoother::NormalEquations& equations) const;

  smoother::FactorGraph graph_;
  smoother::GraphLayout layout_;
  std::vector<smoother::IntervalObservations> observed_;  ///< with the offsets in them
  std::vector<std::vector<int>> offset_of_;               ///< by interval and observation; empty: there are none
  std::vector<Vector2> offsets_;                          ///< [stated sigmas]
  std::vector<Link> links_;                               ///< of each
};

/// Covariances at a problem's estimate (Gauss-Newton approximation).
class DriftCovariance {
 public:
  explicit DriftCovariance(const DriftProblem& problem);

  /// Of δ in T_i⁻¹ T_j Exp(δ), for states i ≠ j; none where the information matrix is singular.
  std::optional<Matrix6> relative(int i, int j) const;

 private:
  const DriftProblem& problem_;
  smoother::SparseCholesky cholesky_;
};

}  // namespace evbench
