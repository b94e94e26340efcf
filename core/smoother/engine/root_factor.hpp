#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/smoother/engine/root.hpp"

namespace evbench::smoother {

/// The Cholesky factor of the root, H = L Lᵀ. Its rows have another order than the root's: landmarks by slot, 3 rows
/// each (a unit diagonal for a free slot), then one or two states, then padding. So the last rows are the
/// factor of the newest states after elimination of the landmarks.
class RootFactor {
 public:
  /// Loads H and b of the root's landmarks and of state `oldest`; zeros for the states after it.
  void load(const Root& root, int oldest, int states);

  int row_of_slot(int slot) const { return 3 * slot; }
  int row_of_states() const { return 3 * slots_; }
  /// The row here of a row of the root's landmarks or of state `oldest`.
  int row_of_root_row(int row) const {
    const int in_slots = row - slots_in_root_;
    return in_slots >= 0 ? in_slots : row_of_states() + row - state_in_root_;
  }
  int size() const { return size_; }  ///< rows, padded; each column has room for kPadding more
  double* column(int c) { return L_.data() + static_cast<std::ptrdiff_t>(c) * stride(); }
  const double* column(int c) const { return L_.data() + static_cast<std::ptrdiff_t>(c) * stride(); }
  int stride() const { return size_ + kPadding; }
  double* b() { return b_.data(); }

  void damp(int row, int rows, double lambda, const double* now) {
    add_damping(L_.data(), stride(), b_.data(), row, rows, lambda, now);
  }

  /// Factorises H into L. Returns the first row that is not determined, −1: none.
  int factorise();

  /// x ← L⁻¹ x and x ← L⁻ᵀ x.
  void solve_forward(double* x) const;
  void solve_back(double* x) const;
  /// X ← L⁻¹ X, where the rows of X before `first` are zero.
  void solve_forward(Eigen::Ref<Eigen::MatrixXd> X, int first) const;

  /// Copies the rows of the landmarks and of state `oldest` from one layout to the other.
  void copy_from_root(const double* root, double* x) const;
  void copy_to_root(const double* x, double* root) const;

 private:
  int slots_ = 0, size_ = 0, state_size_ = 0;
  int state_in_root_ = 0, slots_in_root_ = 0;  ///< rows in the root
  Buffer L_, b_;
};

}  // namespace evbench::smoother
