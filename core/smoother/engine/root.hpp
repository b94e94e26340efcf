#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/smoother/engine/dense_kernels.hpp"
#include "core/smoother/factors.hpp"
#include "core/support/index.hpp"

namespace evbench::smoother {

/// Adds damping to `rows` rows of H from `row` on, and to b so that they are pulled towards the increments `now`. Every
/// three rows (a point, a rotation, ...) get λ times their largest diagonal element, so that no direction of the three
/// is preferred, with a floor for undetermined ones.
inline void add_damping(double* H, std::ptrdiff_t stride, double* b, int row, int rows, double lambda,
                        const double* now) {
  constexpr double kFloor = 1e-6;
  const auto diagonal = [&](int i) -> double& { return H[(row + i) * (stride + 1)]; };
  for (int i = 0; i < rows; i += 3) {
    const double added = lambda * std::max({kFloor, diagonal(i), diagonal(i + 1), diagonal(i + 2)});
    for (int k = i; k < i + 3; ++k) {
      diagonal(k) += added;
      b[row + k] += added * now[k];
    }
  }
}

/// The move of a landmark to another, lower slot.
struct SlotMove {
  int from = 0, to = 0;
};

/// The trailing dense part of the factorisation: information matrix H and right-hand side b (H δ = b) of the newest two
/// states and of the live landmarks, after everything older has been eliminated.
///
/// Layout: with states of n rows (12 or 18), state k occupies n rows from n (k mod 2) on, a landmark the 3 rows of its
/// slot. It keeps that slot until too many lower slots are free: close_holes().
/// Invariant: rows and columns without a variable are zero.
class Root {
 public:
  explicit Root(int state_size) : state_size_(state_size) {}

  int state_size() const { return state_size_; }
  int row_of_state(int state) const { return state_size_ * (state % 2); }
  int row_of_slot(int slot) const { return 2 * state_size_ + 3 * slot; }
  int slot_of_row(int row) const { return (row - 2 * state_size_) / 3; }

  int extent() const { return padded(row_of_slot(top_)); }  ///< rows in use, padded
  int slots() const { return top_; }                        ///< slots in use, with holes
  int stride() const { return stride_; }
  double* H() { return H_.data(); }
  double* b() { return b_.data(); }
  double* column(int c) { return H_.data() + static_cast<std::ptrdiff_t>(c) * stride_; }
  const double* column(int c) const { return H_.data() + static_cast<std::ptrdiff_t>(c) * stride_; }
  const double* b() const { return b_.data(); }

  /// The landmark in a slot, −1: none. The slot of a landmark, −1: not in the root.
  int occupant(int slot) const { return occupant_[index(slot)]; }
  int slot_of(int landmark) const { return index(landmark) < slot_of_.size() ? slot_of_[index(landmark)] : -1; }

  /// Gives a landmark the lowest free slot.
  int enter(int landmark);
  void leave(int landmark);  ///< after an elimination has cleared its rows
  /// Moves landmarks from the highest slots to free ones if there are many of these: the cost grows with the square of
  /// the root's size. Returns the moves in their order.
  void close_holes(std::vector<SlotMove>& moves);
  /// Moves the rows of moved landmarks, in right-hand sides in the root's layout, to their new slots, and back.
  void follow_moves(std::span<const SlotMove> moves, double* x, int stride, int columns) const;
  void undo_moves(std::span<const SlotMove> moves, double* x, int stride, int columns) const;

  void add_state(int state, const StateMatrix& H, const StateVector& b);
  void add_landmark(int landmark, const Matrix3& H, const Vector3& b);
  /// An interval that ends in state k; all its landmarks are in the root.
  void add_interval(int k, const IntervalLinearisation& linear);
  /// A factor |Rᵀ δ − mean|² of any variables; R in the root's layout.
  void add_factor(const Eigen::Ref<const Eigen::MatrixXd>& R, const Eigen::Ref<const Eigen::VectorXd>& mean);
  /// A residual e of landmarks alone with one row J per landmark.
  void add_landmark_factor(std::span<const int> landmarks, const AnchorLinearisation& linear);
  void damp(int row, int rows, double lambda, const double* delta) {
    add_damping(H(), stride_, b(), row, rows, lambda, delta);
  }

  void clear();

  /// A copy of everything but the landmark → slot table.
  struct Snapshot {
    int top = 0;
    std::vector<int> occupant;
    Buffer H, b;

    /// b −= H(:, row...) shift: moves the linearisation point of these rows by `shift`.
    void shift(int row, int size, const double* shift);
  };
  void save(Snapshot& to) const;
  void restore(const Snapshot& from);

 private:
  void reserve(int rows);
  void move(int from, int to);
  void clear_occupants();

  int state_size_;
  int top_ = 0, stride_ = 0;
  Buffer H_, b_;
  std::vector<int> occupant_, slot_of_;
};

}  // namespace evbench::smoother
