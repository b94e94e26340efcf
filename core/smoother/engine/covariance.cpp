#include <algorithm>
#include <array>
#include <iterator>

#include "core/smoother/engine/engine.hpp"

// Marginal covariances. Unit right-hand sides are solved through the factor: forward from the stage that eliminates the
// variable (before it the right-hand side is zero) to the root, and back to that stage only.
namespace evbench::smoother {
namespace {

using Unknown = Factorisation::Unknown;

std::vector<Unknown> following(Unknown first, int count) {
  std::vector<Unknown> result;
  for (int i = 0; i < count; ++i) result.push_back({first.stage, first.row + i});
  return result;
}

}  // namespace

/// x ← H⁻¹ x for the root, both in its layout.
void Factorisation::solve_with_root_factor(double* x) const {
  Buffer y(index(factor_.size()), 0.0);
  factor_.copy_from_root(x, y.data());
  factor_.solve_forward(y.data());
  factor_.solve_back(y.data());
  factor_.copy_to_root(y.data(), x);
}

std::optional<Factorisation::Unknown> Factorisation::find_landmark(int j) const {
  if (root_.slot_of(j) >= 0) return Unknown{done_ + 1, root_.row_of_slot(root_.slot_of(j))};
  const std::optional<int> stage = eliminated_at(j);
  if (!stage) return std::nullopt;
  for (const Conditional& conditional : stages_[index(*stage)].conditionals) {
    const auto found = std::ranges::find(conditional.landmarks, j);
    if (found == conditional.landmarks.end()) continue;
    return Unknown{*stage, conditional.rows[index(found - conditional.landmarks.begin())]};
  }
  return std::nullopt;
}

/// Columns of H⁻¹ in one pass. Each column starts at the stage of its unknown and is read at the stages of all
/// unknowns.
Eigen::MatrixXd Factorisation::covariance(std::span<const Unknown> unknowns) const {
  const int first = unknowns.front().stage, columns = static_cast<int>(unknowns.size()), stride = root_.stride();
  Buffer x(index(stride * columns), 0.0), z;
  auto X = as_matrix(x.data(), stride, columns, stride);
  const auto bring_in = [&](int k) {
    for (int c = 0; c < columns; ++c) {
      if (unknowns[index(c)].stage == k) X(unknowns[index(c)].row, c) = 1.0;
    }
  };
  ForwardPass forward(returns_, first, columns);
  for (int k = first; k <= done_; ++k) {
    const Stage& stage = stages_[index(k)];
    forward.cross(k, x.data(), stride);
    root_.follow_moves(stage.moved, x.data(), stride, columns);
    bring_in(k);
    const int pivots = stage.pivots();
    z.resize(z.size() + index(pivots * columns));
    double* const taken = z.data() + z.size() - index(pivots * columns);
    stage.eliminate(x.data(), stride, taken, columns);
    forward.add(stage.returned, taken, pivots);
  }
  forward.cross(done_ + 1, x.data(), stride);
  bring_in(done_ + 1);
  for (int c = 0; c < columns; ++c) solve_with_root_factor(X.col(c).data());

  Eigen::MatrixXd result(columns, columns);
  const auto read = [&](int k) {
    for (int u = 0; u < columns; ++u) {
      if (unknowns[index(u)].stage == k) result.row(u) = X.row(unknowns[index(u)].row);
    }
  };
  read(done_ + 1);
  BackwardPass back;
  back.start(returns_, forward.first(), forward.g());
  back.cross(returns_, done_ + 1, x.data(), stride);
  double* end = z.data() + z.size();
  for (int k = done_; k >= first; --k) {
    const Stage& stage = stages_[index(k)];
    const int pivots = stage.pivots();
    end -= pivots * columns;
    back.shift(stage.returned, end, pivots);
    stage.back_substitute(end, x.data(), stride, columns);
    read(k);
    root_.undo_moves(stage.moved, x.data(), stride, columns);
    back.cross(returns_, k, x.data(), stride);
  }
  return 0.5 * (result + result.transpose());
}

/// The covariance of all variables in the root, in its layout; zero for free slots.
Eigen::MatrixXd Factorisation::root_covariance() const {
  const int n = factor_.row_of_states() + root_.state_size();
  Eigen::MatrixXd half = Eigen::MatrixXd::Identity(n, n);  // L⁻¹
  as_matrix(factor_.column(0), n, n, factor_.stride()).triangularView<Eigen::Lower>().solveInPlace(half);
  Eigen::MatrixXd covariance(n, n);
  covariance.noalias() = half.transpose() * half;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(root_.stride(), n);
  for (int c = 0; c < n; ++c) factor_.copy_to_root(covariance.col(c).data(), rows.col(c).data());
  covariance = rows.transpose();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(root_.stride(), root_.stride());
  for (int c = 0; c < root_.stride(); ++c) factor_.copy_to_root(covariance.col(c).data(), result.col(c).data());
  return result;
}

/// Adds the moments of one return's μ to S. S holds second moments: of the root's variables in its layout and, after
/// them, by id, of the μ of returned landmarks. μ = L⁻ᵀ (Rᵀ δ − mean − ...). Its covariance is reduced by the share
/// that the noise of the earlier stages has by itself. This noise, of mean Z μ, can then be treated as independent.
void Factorisation::add_return_moments(int position, Eigen::MatrixXd& S) const {
  const Return& e = returns_[position];
  MatrixX3 W = MatrixX3::Zero(S.rows(), 3);
  W.topRows(e.R.rows()) = e.R;
  for (int later = position + 1; later < returns_.size(); ++later) {
    const Return& f = returns_[later];
    if (f.first > position) continue;
    W.middleRows<3>(root_.stride() + 3 * f.id) = -f.g.middleRows<3>(3 * (position - f.first)).transpose();
  }
  MatrixX3 moments = S * W;
  Matrix3 own = W.transpose() * moments - Matrix3::Identity();
  const auto L = e.L.triangularView<Eigen::Lower>();
  L.solveInPlace<Eigen::OnTheRight>(moments);
  L.solveInPlace<Eigen::OnTheRight>(own);
  L.transpose().solveInPlace(own);
  const int row = root_.stride() + 3 * e.id;
  S.middleCols<3>(row) = moments;
  S.middleRows<3>(row) = moments.transpose();
  S.block<3, 3>(row, row) = 0.5 * (own + own.transpose());
}

/// The covariance Σ of the remaining root gives that of the variables of a conditional: with X = A L⁻¹, δ_p = L⁻ᵀ y −
/// Xᵀ δ_r and Σ_rp = −Σ_rr X, Σ_pp = (L Lᵀ)⁻¹ − Xᵀ Σ_rp. Returned landmarks extend the rest; their rows of A are −Zᵀ.
std::vector<PairMatrix> Factorisation::chain(int first) const {
  std::vector<PairMatrix> result(index(std::max(0, done_ - first + 1)));
  const int size = root_.stride() + 3 * returns_.ids();
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(size, size), X, S_rp;
  S.topLeftCorner(root_.stride(), root_.stride()) = root_covariance();
  int met = returns_.size();
  const auto meet = [&](int k) {
    while (met > 0 && returns_[met - 1].before == k) add_return_moments(--met, S);
  };
  meet(done_ + 1);
  for (int k = done_; k >= first; --k) {
    const auto& conditionals = stages_[index(k)].conditionals;
    const ReturnRows& returned = stages_[index(k)].returned;
    const int returned_rows = 3 * static_cast<int>(returned.ids.size());
    int end = stages_[index(k)].pivots();
    for (auto c = conditionals.rbegin(); c != conditionals.rend(); ++c) {
      const int n = c->extent, p = c->pivots, rows = returned.ids.empty() ? n : size;
      end -= p;
      const auto L = as_matrix(c->L.data(), p, p, p);
      X.resize(n + returned_rows, p);
      X.topRows(n) = as_matrix(c->A.data(), n, p, n);
      X.bottomRows(returned_rows) =
          -as_matrix(returned.Zt.data() + end * returned.stride, returned_rows, p, returned.stride);
      L.triangularView<Eigen::Lower>().solveInPlace<Eigen::OnTheRight>(X);
      S_rp.noalias() = -S.topLeftCorner(rows, n) * X.topRows(n);
      for (std::size_t i = 0; i < returned.ids.size(); ++i) {
        S_rp.noalias() -=
            S.middleCols<3>(root_.stride() + 3 * returned.ids[i]) * X.middleRows<3>(n + 3 * static_cast<int>(i));
      }
      Eigen::MatrixXd half = Eigen::MatrixXd::Identity(p, p);
      L.triangularView<Eigen::Lower>().solveInPlace(half);
      Eigen::MatrixXd S_pp = half.transpose() * half;
      S_pp.noalias() -= X.topRows(n).transpose() * S_rp.topRows(n);
      for (std::size_t i = 0; i < returned.ids.size(); ++i) {
        S_pp.noalias() -= X.middleRows<3>(n + 3 * static_cast<int>(i)).transpose() *
                          S_rp.middleRows<3>(root_.stride() + 3 * returned.ids[i]);
      }
      std::vector<int> places;
      c->for_each_pivot([&](int row, int count) {
        for (int i = 0; i < count; ++i) places.push_back(row + i);
      });
      for (int i = 0; i < p; ++i) {
        S.col(places[index(i)]).head(rows) = S_rp.col(i);
        S.row(places[index(i)]).head(rows) = S_rp.col(i).transpose();
      }
      for (int i = 0; i < p; ++i) {
        for (int j = 0; j < p; ++j) S(places[index(i)], places[index(j)]) = 0.5 * (S_pp(i, j) + S_pp(j, i));
      }
    }
    const int older = root_.row_of_state(k - 1), newer = root_.row_of_state(k);
    const int n = root_.state_size();
    PairMatrix& joint = result[index(k - first)];
    joint.resize(2 * n, 2 * n);
    joint << S.block(older, older, n, n), S.block(older, newer, n, n), S.block(newer, older, n, n),
        S.block(newer, newer, n, n);
    const std::vector<SlotMove>& moved = stages_[index(k)].moved;
    root_.undo_moves(moved, S.data(), size, size);
    for (auto move = moved.rbegin(); move != moved.rend(); ++move) {
      S.middleCols<3>(root_.row_of_slot(move->from)) = S.middleCols<3>(root_.row_of_slot(move->to));
    }
    meet(k);
  }
  return result;
}

/// J H⁻¹ Jᵀ = Xᵀ X with X = L⁻¹ Jᵀ.
Eigen::MatrixXd Factorisation::image_in_root(std::span<const int> rows, const Eigen::MatrixXd& J) const {
  Eigen::MatrixXd X = Eigen::MatrixXd::Zero(factor_.size(), J.rows());
  int first = factor_.size();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int row = factor_.row_of_root_row(rows[i]);
    X.row(row) = J.col(static_cast<Eigen::Index>(i)).transpose();
    first = std::min(first, row);
  }
  factor_.solve_forward(X, first);
  return X.transpose() * X;
}

/// Factorises everything that has changed or was damped, without damping, at the present linearisation points.
bool Engine::factorise_undamped() {
  const int states = static_cast<int>(graph_.states.size());
  if (restart_ < states || factorisation_.done() >= states || damped_) {  // or states were removed
    if (factorisation_.redo(restart_, graph_, points_, 0.0)) return false;
    restart_ = states;
    damped_ = factorisation_.factorise_root(points_, 0.0).has_value();  // if it failed, there is no factor to use
    if (damped_) return false;
  }
  return true;
}

std::optional<PairMatrix> Engine::neighbours(int k) {
  const Root& root = factorisation_.root();
  if (k < first_state() || k + 1 >= static_cast<int>(graph_.states.size()) || !factorise_undamped())
    return std::nullopt;
  std::vector<Unknown> unknowns = following({k + 1, root.row_of_state(k)}, root.state_size());
  std::ranges::copy(following({k + 1, root.row_of_state(k + 1)}, root.state_size()), std::back_inserter(unknowns));
  const PairMatrix joint = factorisation_.covariance(unknowns);
  if (!joint.allFinite()) return std::nullopt;
  return joint;
}

std::vector<PairMatrix> Engine::chain_covariances(int first) {
  if (first < 1 || first <= first_state() || !factorise_undamped()) return {};
  std::vector<PairMatrix> chain = factorisation_.chain(first);
  if (!std::ranges::all_of(chain, [](const PairMatrix& joint) { return joint.allFinite(); })) return {};
  return chain;
}

std::optional<Matrix12> Engine::poses(int i, int j) {
  const Root& root = factorisation_.root();
  if (i < first_state() || j <= i || j >= static_cast<int>(graph_.states.size()) || !factorise_undamped())
    return std::nullopt;
  std::vector<Unknown> unknowns = following({i + 1, root.row_of_state(i)}, 6);
  std::ranges::copy(following({j, root.row_of_state(j)}, 6), std::back_inserter(unknowns));
  const Matrix12 joint = factorisation_.covariance(unknowns);
  if (!joint.allFinite()) return std::nullopt;
  return joint;
}

std::optional<Matrix12> Engine::covariance(double t) {
  const int k = graph_.interval_of(t);
  if (k < 1) return std::nullopt;
  if (t == graph_.states.back().t) return newest_covariance();
  const std::optional<PairMatrix> joint = neighbours(k - 1);
  if (!joint) return std::nullopt;
  return graph_.interval(k).covariance(t, *joint, graph_.qcs[index(k)]);
}

std::optional<Matrix12> Engine::newest_covariance() {
  if (!factorise_undamped()) return std::nullopt;
  std::array<int, 12> rows;
  for (int i = 0; i < 12; ++i)
    rows[index(i)] = factorisation_.root().row_of_state(static_cast<int>(graph_.states.size()) - 1) + i;
  const Matrix12 result = factorisation_.image_in_root(rows, Matrix12::Identity());
  if (!result.allFinite()) return std::nullopt;
  return result;
}

std::optional<Matrix3> Engine::landmark_covariance(int landmark) {
  if (!factorise_undamped()) return std::nullopt;
  const std::optional<Unknown> place = factorisation_.find_landmark(landmark);
  if (!place) return std::nullopt;
  const Matrix3 result = factorisation_.covariance(following(*place, 3));
  if (!result.allFinite()) return std::nullopt;
  return result;
}

std::optional<Matrix2> Engine::predicted_covariance(int landmark, const ImageJacobian& J_state,
                                                    const Matrix23& J_landmark) {
  if (!factorise_undamped()) return std::nullopt;
  const std::optional<Unknown> place = factorisation_.find_landmark(landmark);
  const bool in_root = place && place->stage == static_cast<int>(graph_.states.size());
  std::vector<int> rows;
  for (int i = 0; i < J_state.cols(); ++i)
    rows.push_back(factorisation_.root().row_of_state(static_cast<int>(graph_.states.size()) - 1) + i);
  if (in_root) {
    for (int i = 0; i < 3; ++i) rows.push_back(place->row + i);
  }
  Eigen::MatrixXd J(2, rows.size());
  J.leftCols(J_state.cols()) = J_state;
  if (in_root) J.rightCols<3>() = J_landmark;
  Matrix2 result = factorisation_.image_in_root(rows, J);
  if (!in_root) {
    const std::optional<Matrix3> own = landmark_covariance(landmark);
    if (!own) return std::nullopt;
    result += J_landmark * *own * J_landmark.transpose();
  }
  if (!result.allFinite()) return std::nullopt;
  return Matrix2(0.5 * (result + result.transpose()));
}

}  // namespace evbench::smoother
