#include <algorithm>
#include <array>

#include "backends/gp_map/engine/engine.hpp"

// Marginal covariances by solving for unit right-hand sides through the factor: forward from the stage in which the
// variable is eliminated (before that the right-hand side is zero) to the root, and back to that stage only.
namespace evbench::gp_map {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Calls visit(first row in the root's layout, size) for each pivot variable.
template <class Visit>
void for_each_pivot(const Conditional& conditional, Visit visit) {
  for (std::size_t i = 0; i < conditional.rows.size(); ++i) {
    visit(conditional.rows[i], i < conditional.landmarks.size() ? 3 : 12);
  }
}

/// z = L⁻¹ r_p; r_p ← 0; r_rest −= A z.
void eliminate_right_side(const Conditional& c, double* r, double* z) {
  double* to = z;
  for_each_pivot(c, [&](int row, int size) {
    to = std::copy(r + row, r + row + size, to);
    std::fill(r + row, r + row + size, 0.0);
  });
  solve_lower(c.L.data(), c.pivots, c.pivots, z);
  subtract_product(r, c.A.data(), c.extent, c.extent, c.pivots, z);
}

/// x_p = L⁻ᵀ (z − Aᵀ x).
void solve_back_right_side(const Conditional& c, double* x, double* z) {
  subtract_transposed_product(z, c.A.data(), c.extent, c.extent, c.pivots, x);
  solve_lower_transposed(c.L.data(), c.pivots, c.pivots, z);
  const double* from = z;
  for_each_pivot(c, [&](int row, int size) {
    std::copy(from, from + size, x + row);
    from += size;
  });
}

}  // namespace

Eigen::MatrixXd Factorisation::marginal(int stage, std::span<const int> rows) const {
  const auto size = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd result(size, size);
  Buffer x(at(root_.stride())), z;
  for (Eigen::Index column = 0; column < size; ++column) {
    std::ranges::fill(x, 0.0);
    x[at(rows[static_cast<std::size_t>(column)])] = 1.0;
    z.clear();
    for (int k = stage; k <= done_; ++k) {
      for (const Conditional& c : stages_[at(k)].conditionals) {
        z.resize(z.size() + at(c.pivots));
        eliminate_right_side(c, x.data(), z.data() + z.size() - c.pivots);
      }
    }
    solve_with_root_factor(x.data());
    double* end = z.data() + z.size();
    for (int k = done_; k >= stage; --k) {
      const auto& conditionals = stages_[at(k)].conditionals;
      for (auto c = conditionals.rbegin(); c != conditionals.rend(); ++c) {
        end -= c->pivots;
        solve_back_right_side(*c, x.data(), end);
      }
    }
    for (Eigen::Index row = 0; row < size; ++row) result(row, column) = x[at(rows[static_cast<std::size_t>(row)])];
  }
  return 0.5 * (result + result.transpose());
}

Eigen::MatrixXd Factorisation::image_in_root(std::span<const int> rows, const Eigen::MatrixXd& J) const {
  Eigen::MatrixXd solved(static_cast<Eigen::Index>(rows.size()), J.rows());
  Buffer x(at(root_.stride()));
  for (Eigen::Index i = 0; i < J.rows(); ++i) {
    std::ranges::fill(x, 0.0);
    for (std::size_t k = 0; k < rows.size(); ++k) x[at(rows[k])] = J(i, static_cast<Eigen::Index>(k));
    solve_with_root_factor(x.data());
    for (std::size_t k = 0; k < rows.size(); ++k) solved(static_cast<Eigen::Index>(k), i) = x[at(rows[k])];
  }
  return J * solved;
}

/// Factorises what has changed or was damped, as it is at the present linearisation points.
bool Engine::factorise_undamped() {
  if (restart_ < static_cast<int>(graph_.states.size()) || damped_) {
    if (factorisation_.redo(restart_, graph_, points_, 0.0)) return false;
    restart_ = static_cast<int>(graph_.states.size());
    damped_ = factorisation_.factorise_root(points_, 0.0).has_value();  // if it failed, there is no factor to use
    if (damped_) return false;
  }
  return true;
}

std::optional<Matrix24> Engine::neighbours(int k) {
  if (k < first_state() || k + 1 >= static_cast<int>(graph_.states.size()) || !factorise_undamped())
    return std::nullopt;
  std::array<int, 24> rows;
  for (int i = 0; i < 12; ++i) {
    rows[at(i)] = Root::row_of_state(k) + i;
    rows[at(12 + i)] = Root::row_of_state(k + 1) + i;
  }
  const Matrix24 joint = factorisation_.marginal(k + 1, rows);
  if (!joint.allFinite()) return std::nullopt;
  return joint;
}

std::optional<Matrix12> Engine::covariance(double t) {
  const int k = graph_.interval_of(t);
  if (k < 1) return std::nullopt;
  const std::optional<Matrix24> joint = neighbours(k - 1);
  if (!joint) return std::nullopt;
  return GpInterval(graph_.states[at(k - 1)], graph_.states[at(k)]).covariance(t, *joint, graph_.qc);
}

std::optional<Matrix3> Engine::landmark_covariance(int landmark) {
  if (!factorise_undamped()) return std::nullopt;
  const std::optional<std::pair<int, int>> place = factorisation_.find_landmark(landmark);
  if (!place) return std::nullopt;
  const auto [stage, row] = *place;
  const std::array<int, 3> rows = {row, row + 1, row + 2};
  const Matrix3 result = factorisation_.marginal(stage, rows);
  if (!result.allFinite()) return std::nullopt;
  return result;
}

std::optional<Matrix2> Engine::predicted_covariance(int landmark, const Eigen::Matrix<double, 2, 12>& J_state,
                                                    const Matrix23& J_landmark) {
  if (!factorise_undamped()) return std::nullopt;
  const std::optional<std::pair<int, int>> place = factorisation_.find_landmark(landmark);
  const bool in_root = place && place->first == static_cast<int>(graph_.states.size());
  std::vector<int> rows;
  for (int i = 0; i < 12; ++i) rows.push_back(Root::row_of_state(static_cast<int>(graph_.states.size()) - 1) + i);
  Eigen::MatrixXd J = J_state;
  if (in_root) {
    for (int i = 0; i < 3; ++i) rows.push_back(place->second + i);
    J.conservativeResize(2, 15);
    J.rightCols<3>() = J_landmark;
  }
  Matrix2 result = factorisation_.image_in_root(rows, J);
  if (!in_root) {
    const std::optional<Matrix3> own = landmark_covariance(landmark);
    if (!own) return std::nullopt;
    result += J_landmark * *own * J_landmark.transpose();
  }
  if (!result.allFinite()) return std::nullopt;
  return Matrix2(0.5 * (result + result.transpose()));
}

}  // namespace evbench::gp_map
