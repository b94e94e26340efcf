#include "core/smoother/batch_solver.hpp"

#include "core/smoother/factors.hpp"
#include "core/smoother/graph_variables.hpp"
#include "core/support/index.hpp"

namespace evbench::smoother {
namespace {

/// A graph as a problem of minimise().
struct GraphProblem {
  FactorGraph& graph;
  GraphLayout layout{graph};

  double cost() const { return evaluate(graph).total(); }
  NormalEquations linearise() const {
    NormalEquations equations(layout.size);
    add_factors(graph, layout, equations);
    return equations;
  }
  void apply(const Eigen::VectorXd& step) { apply_step(graph, layout, step); }
  GraphEstimate estimate() const { return GraphEstimate(graph); }
  void restore(const GraphEstimate& estimate) { estimate.restore(graph); }
};

}  // namespace

BatchSummary solve_batch(FactorGraph& graph, const BatchOptions& options) {
  GraphProblem problem{graph};
  if (problem.layout.size > 0) return minimise(problem, options);
  BatchSummary nothing;
  nothing.converged = true;
  return nothing;
}

struct BatchCovariance::Factor {
  GraphLayout layout;
  SparseCholesky cholesky;
  bool usable = false;

  explicit Factor(const FactorGraph& graph) : layout(graph) {
    NormalEquations equations(layout.size);
    add_factors(graph, layout, equations);
    cholesky.compute(equations.matrix());
    usable = cholesky.info() == Eigen::Success;
  }

  /// Marginal covariance of `size` variables from `offset` on.
  Eigen::MatrixXd marginal(int offset, int size) const { return cross(offset, offset, size); }

  /// Covariance of `size` variables from `i` on with as many from `j` on.
  Eigen::MatrixXd cross(int i, int j, int size) const {
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(layout.size, size);
    unit.block(j, 0, size, size).setIdentity();
    const Eigen::MatrixXd columns = cholesky.solve(unit);
    return columns.middleRows(i, size);
  }
};

BatchCovariance::BatchCovariance(const FactorGraph& graph) : graph_(graph), factor_(std::make_unique<Factor>(graph)) {}
BatchCovariance::~BatchCovariance() = default;

std::optional<PairMatrix> BatchCovariance::neighbours(int k) const {
  if (!factor_->usable || k < 0 || index(k + 1) >= graph_.states.size()) return std::nullopt;
  // Neighbours are adjacent.
  const PairMatrix joint = factor_->marginal(factor_->layout.state_offset[index(k)], 2 * factor_->layout.state_size);
  if (!joint.allFinite()) return std::nullopt;
  return joint;
}

std::optional<Matrix12> BatchCovariance::poses(int i, int j) const {
  if (!factor_->usable) return std::nullopt;
  const int at_i = factor_->layout.state_offset[index(i)], at_j = factor_->layout.state_offset[index(j)];
  Matrix12 joint;
  joint << factor_->marginal(at_i, 6), factor_->cross(at_i, at_j, 6), factor_->cross(at_j, at_i, 6),
      factor_->marginal(at_j, 6);
  return joint;
}

std::optional<Matrix12> BatchCovariance::at(double t) const {
  const int k = graph_.interval_of(t);
  if (k < 1) return std::nullopt;
  const std::optional<PairMatrix> joint = neighbours(k - 1);
  if (!joint) return std::nullopt;
  const GpInterval interval = graph_.interval(k);
  return interval.covariance(t, *joint, graph_.qcs[index(k)]);
}

std::optional<Matrix3> BatchCovariance::landmark(int landmark) const {
  if (!factor_->usable || factor_->layout.landmark_offset[index(landmark)] < 0) return std::nullopt;
  return Matrix3(factor_->marginal(factor_->layout.landmark_offset[index(landmark)], 3));
}

}  // namespace evbench::smoother
