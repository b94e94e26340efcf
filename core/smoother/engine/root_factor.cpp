#include "core/smoother/engine/root_factor.hpp"

#include <Eigen/Core>
#include <algorithm>

#include "core/support/index.hpp"

namespace evbench::smoother {

void RootFactor::load(const Root& root, int oldest, int states) {
  slots_ = root.slots();
  state_size_ = root.state_size();
  state_in_root_ = root.row_of_state(oldest);
  slots_in_root_ = root.row_of_slot(0);
  const int landmark_rows = row_of_states(), rows = landmark_rows + state_size_ * states;
  size_ = padded(rows);
  L_.assign(index(size_) * index(stride()), 0.0);
  b_.assign(index(size_), 0.0);
  copy_from_root(root.b(), b_.data());
  for (int c = 0; c < landmark_rows; ++c) {
    const double* from = root.column(slots_in_root_ + c) + slots_in_root_;
    std::copy(from + c, from + landmark_rows, column(c) + c);
    // The state comes before the landmarks in the root, whose lower triangle is valid.
    for (int r = 0; r < state_size_; ++r)
      column(c)[landmark_rows + r] = root.column(state_in_root_ + r)[slots_in_root_ + c];
    if (root.occupant(c / 3) < 0) column(c)[c] = 1.0;
  }
  for (int c = 0; c < state_size_; ++c) {
    const double* from = root.column(state_in_root_ + c) + state_in_root_;
    std::copy(from + c, from + state_size_, column(landmark_rows + c) + landmark_rows + c);
  }
  for (int i = rows; i < size_; ++i) column(i)[i] = 1.0;
}

int RootFactor::factorise() { return cholesky_blocked(L_.data(), stride(), size_, kPivotTolerance); }

void RootFactor::solve_forward(double* x) const {
  as_matrix(L_.data(), size_, size_, stride()).triangularView<Eigen::Lower>().solveInPlace(as_vector(x, size_));
}

void RootFactor::solve_back(double* x) const {
  const auto L = as_matrix(L_.data(), size_, size_, stride());
  L.transpose().triangularView<Eigen::Upper>().solveInPlace(as_vector(x, size_));
}

void RootFactor::solve_forward(Eigen::Ref<Eigen::MatrixXd> X, int first) const {
  const int rows = size_ - first;
  const auto L = as_matrix(L_.data(), size_, size_, stride());
  L.bottomRightCorner(rows, rows).triangularView<Eigen::Lower>().solveInPlace(X.bottomRows(rows));
}

void RootFactor::copy_from_root(const double* root, double* x) const {
  std::copy_n(root + slots_in_root_, row_of_states(), x);
  std::copy_n(root + state_in_root_, state_size_, x + row_of_states());
}

void RootFactor::copy_to_root(const double* x, double* root) const {
  std::copy_n(x, row_of_states(), root + slots_in_root_);
  std::copy_n(x + row_of_states(), state_size_, root + state_in_root_);
}

}  // namespace evbench::smoother
