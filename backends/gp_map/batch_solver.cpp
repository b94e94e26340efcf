#include "backends/gp_map/batch_solver.hpp"

#include <Eigen/CholmodSupport>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/support/index.hpp"

namespace evbench::gp_map {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplet = Eigen::Triplet<double>;

constexpr int kStateSize = 12;
constexpr int kLandmarkSize = 3;

/// A matrix that is not positive definite is a result here, not a warning on the console.
struct Cholesky : Eigen::CholmodSupernodalLLT<Sparse, Eigen::Lower> {
  Cholesky() { cholmod().print = 0; }
};

/// Where the variables stand in the vector; −1: landmarks that nobody observes.
struct Layout {
  int size = 0;
  std::vector<int> state_offset, landmark_offset;

  explicit Layout(const FactorGraph& graph);
};

Layout::Layout(const FactorGraph& graph)
    : state_offset(graph.states.size(), -1), landmark_offset(graph.landmarks.size(), -1) {
  // Landmarks come first: they are eliminated first.
  for (std::size_t j = 0; j < graph.landmarks.size(); ++j) {
    if (graph.landmarks[j].intervals.empty()) continue;
    landmark_offset[j] = size;
    size += kLandmarkSize;
  }
  for (int& offset : state_offset) {
    offset = size;
    size += kStateSize;
  }
}

/// The normal equations H δ = −g (lower triangle) of all factors.
class NormalEquations {
 public:
  Sparse matrix;
  Eigen::VectorXd gradient;

  NormalEquations(const FactorGraph& graph, const Layout& layout) : gradient(layout.size), layout_(layout) {
    gradient.setZero();
    IntervalLinearisation linear;
    for (int k = 1; k < static_cast<int>(graph.states.size()); ++k) {
      linearise_interval(graph, k, linear);
      add_interval(k, linear);
    }
    add_priors(graph);
    matrix.resize(layout.size, layout.size);
    matrix.setFromTriplets(triplets_.begin(), triplets_.end());
  }

 private:
  const Layout& layout_;
  std::vector<Triplet> triplets_;

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
    if (row >= 0) gradient.segment(row, segment.size()) += segment;
  }

  void add_interval(int k, const IntervalLinearisation& linear) {
    const int x0 = layout_.state_offset[index(k - 1)], x1 = layout_.state_offset[index(k)];
    add_block(x0, x0, Matrix12(linear.states.topLeftCorner<12, 12>()));
    add_block(x1, x0, Matrix12(linear.states.bottomLeftCorner<12, 12>()));
    add_block(x1, x1, Matrix12(linear.states.bottomRightCorner<12, 12>()));
    add_gradient(x0, linear.gradient.head<12>());
    add_gradient(x1, linear.gradient.tail<12>());
    for (const auto& coupling : linear.couplings) {
      const int l = layout_.landmark_offset[index(coupling.landmark)];
      using Matrix3x12 = Eigen::Matrix<double, 3, 12>;
      add_block(l, l, coupling.landmark_landmark);
      add_block(l, x0, Matrix3x12(coupling.landmark_states.leftCols<12>()));
      add_block(l, x1, Matrix3x12(coupling.landmark_states.rightCols<12>()));
      add_gradient(l, coupling.gradient);
    }
  }

  void add_priors(const FactorGraph& graph) {
    for (std::size_t i = 0; i < graph.states.size(); ++i) {
      if (layout_.state_offset[i] < 0) continue;
      Matrix12 H = Matrix12::Zero();
      Vector12 g = Vector12::Zero();
      add_state_priors(graph, static_cast<int>(i), H, g);
      add_block(layout_.state_offset[i], layout_.state_offset[i], H);
      add_gradient(layout_.state_offset[i], g);
    }
    for (std::size_t j = 0; j < graph.landmarks.size(); ++j) {
      const LandmarkPrior& prior = graph.landmarks[j].prior;
      const int l = layout_.landmark_offset[j];
      if (l < 0 || !std::isfinite(prior.sigma)) continue;
      const double information = 1.0 / (prior.sigma * prior.sigma);
      add_block(l, l, Matrix3(information * Matrix3::Identity()));
      add_gradient(l, Vector3(information * (graph.landmarks[j].position - prior.position)));
    }
    add_anchor(graph);
  }

  void add_anchor(const FactorGraph& graph) {
    const std::vector<int>& anchors = graph.anchor.landmarks;
    const AnchorLinearisation linear = linearise_anchor(graph);
    for (std::size_t a = 0; a < anchors.size(); ++a) {
      const int row = layout_.landmark_offset[index(anchors[a])];
      add_gradient(row, Vector3(linear.e * linear.jacobian[a]));
      for (std::size_t b = 0; b <= a; ++b) {
        const int column = layout_.landmark_offset[index(anchors[b])];
        add_block(row, column, Matrix3(linear.jacobian[a] * linear.jacobian[b].transpose()));
      }
    }
  }
};

void apply(FactorGraph& graph, const Layout& layout, const Eigen::VectorXd& step) {
  for (std::size_t i = 0; i < graph.states.size(); ++i) {
    graph.states[i] = graph.states[i].retract(step.segment<kStateSize>(layout.state_offset[i]));
  }
  for (std::size_t j = 0; j < graph.landmarks.size(); ++j) {
    if (layout.landmark_offset[j] >= 0) {
      graph.landmarks[j].position += step.segment<kLandmarkSize>(layout.landmark_offset[j]);
    }
  }
}

class Estimate {  // what a step changes, to undo it
 public:
  explicit Estimate(const FactorGraph& graph) : states_(graph.states) {
    positions_.reserve(graph.landmarks.size());
    for (const auto& landmark : graph.landmarks) positions_.push_back(landmark.position);
  }
  void restore(FactorGraph& graph) const {
    graph.states = states_;
    for (std::size_t j = 0; j < positions_.size(); ++j) graph.landmarks[j].position = positions_[j];
  }

 private:
  std::vector<ControlState> states_;
  std::vector<Vector3> positions_;
};

}  // namespace

BatchSummary solve_batch(FactorGraph& graph, const BatchOptions& options) {
  BatchSummary summary;
  const Layout layout(graph);
  if (layout.size == 0) {
    summary.converged = true;
    return summary;
  }
  summary.initial_cost = summary.final_cost = evaluate(graph).total();
  Cholesky cholesky;
  bool analysed = false;
  double damping = 1e-6;  // relative to the diagonal
  constexpr double kMaxDamping = 1e8;
  constexpr double kLeastInformation = 1e-3;
  while (summary.iterations < options.max_iterations && !summary.converged) {
    NormalEquations equations(graph, layout);
    if (!analysed) cholesky.analyzePattern(equations.matrix);
    analysed = true;
    // The floor keeps a variable that nothing tells (a landmark behind every camera that saw it) from being singular.
    const Eigen::VectorXd diagonal = equations.matrix.diagonal().cwiseMax(kLeastInformation);
    const Estimate before(graph);
    bool accepted = false;
    while (!accepted && damping < kMaxDamping) {
      Sparse damped = equations.matrix;
      damped.diagonal() += damping * diagonal;
      cholesky.factorize(damped);
      bool usable = cholesky.info() == Eigen::Success;
      if (usable) {
        const Eigen::VectorXd step = cholesky.solve(-equations.gradient);
        usable = step.allFinite();
        if (usable) apply(graph, layout, step);
      }
      const double cost = usable ? evaluate(graph).total() : 0.0;
      accepted = usable && cost <= summary.final_cost;  // false for NaN
      if (accepted) {
        summary.converged = summary.final_cost - cost <= options.relative_tolerance * summary.final_cost;
        summary.final_cost = cost;
        damping = std::max(1e-12, damping * 0.1);
      } else {
        before.restore(graph);
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

struct BatchCovariance::Factor {
  Layout layout;
  Cholesky cholesky;
  bool usable = false;

  explicit Factor(const FactorGraph& graph) : layout(graph) {
    const NormalEquations equations(graph, layout);
    cholesky.compute(equations.matrix);
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

std::optional<Matrix24> BatchCovariance::neighbours(int k) const {
  if (!factor_->usable || k < 0 || index(k + 1) >= graph_.states.size()) return std::nullopt;
  const Matrix24 joint =
      factor_->marginal(factor_->layout.state_offset[index(k)], 24);  // neighbours stand side by side
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
  const std::optional<Matrix24> joint = neighbours(k - 1);
  if (!joint) return std::nullopt;
  const GpInterval interval(graph_.states[index(k - 1)], graph_.states[index(k)]);
  return interval.covariance(t, *joint, graph_.qcs[index(k)]);
}

std::optional<Matrix3> BatchCovariance::landmark(int landmark) const {
  if (!factor_->usable || factor_->layout.landmark_offset[index(landmark)] < 0) return std::nullopt;
  return Matrix3(factor_->marginal(factor_->layout.landmark_offset[index(landmark)], 3));
}

}  // namespace evbench::gp_map
