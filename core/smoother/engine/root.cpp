#include "core/smoother/engine/root.hpp"

#include <algorithm>
#include <utility>

namespace evbench::smoother {

int Root::enter(int landmark) {
  const auto free = std::find(occupant_.begin(), occupant_.begin() + top_, -1);
  const int slot = static_cast<int>(free - occupant_.begin());
  if (slot == top_) {
    ++top_;
    if (static_cast<int>(occupant_.size()) < top_) occupant_.push_back(-1);
    reserve(extent());
  }
  occupant_[index(slot)] = landmark;
  if (slot_of_.size() <= index(landmark)) slot_of_.resize(index(landmark) + 1, -1);
  slot_of_[index(landmark)] = slot;
  return slot;
}

void Root::leave(int landmark) {
  occupant_[index(slot_of(landmark))] = -1;
  slot_of_[index(landmark)] = -1;
  while (top_ > 0 && occupant_[index(top_ - 1)] < 0) --top_;
}

void Root::close_holes(std::vector<SlotMove>& moves) {
  constexpr int kBearable = 4;
  moves.clear();
  int holes = static_cast<int>(std::count(occupant_.begin(), occupant_.begin() + top_, -1));
  if (holes <= kBearable) return;
  for (int to = 0; holes > 0; ++to) {
    if (occupant_[index(to)] >= 0) continue;
    move(top_ - 1, to);
    moves.push_back({top_ - 1, to});
    --holes;
    for (--top_; occupant_[index(top_ - 1)] < 0; --top_) --holes;
  }
}

void Root::move(int from, int to) {
  const int n = extent();
  for (int i = 0; i < 3; ++i) {
    const int a = row_of_slot(from) + i, b = row_of_slot(to) + i;
    const auto take = [](double& value) { return std::exchange(value, 0.0); };
    for (int c = 0; c < b; ++c) column(c)[b] = take(column(c)[a]);
    column(b)[b] = take(column(a)[a]);
    for (int c = b + 1; c < a; ++c) column(b)[c] = take(column(c)[a]);
    for (int r = a + 1; r < n; ++r) column(b)[r] = take(column(a)[r]);
    b_[index(b)] = take(b_[index(a)]);
  }
  const int landmark = std::exchange(occupant_[index(from)], -1);
  occupant_[index(to)] = landmark;
  slot_of_[index(landmark)] = to;
}

void Root::follow_moves(std::span<const SlotMove> moves, double* x, int stride, int columns) const {
  for (const auto [from, to] : moves) {
    for (int c = 0; c < columns; ++c, x += stride) {
      std::copy_n(x + row_of_slot(from), 3, x + row_of_slot(to));
      std::fill_n(x + row_of_slot(from), 3, 0.0);
    }
    x -= columns * stride;
  }
}

void Root::undo_moves(std::span<const SlotMove> moves, double* x, int stride, int columns) const {
  for (auto move = moves.rbegin(); move != moves.rend(); ++move) {
    for (int c = 0; c < columns; ++c, x += stride) {
      std::copy_n(x + row_of_slot(move->to), 3, x + row_of_slot(move->from));
    }
    x -= columns * stride;
  }
}

void Root::add_state(int state, const StateMatrix& H, const StateVector& b) {
  reserve(extent());
  const int row = row_of_state(state);
  for (int c = 0; c < state_size_; ++c) {
    for (int r = c; r < state_size_; ++r) column(row + c)[row + r] += H(r, c);
    b_[index(row + c)] += b(c);
  }
}

void Root::add_landmark(int landmark, const Matrix3& H, const Vector3& b) {
  const int row = row_of_slot(slot_of(landmark));
  for (int c = 0; c < 3; ++c) {
    for (int r = c; r < 3; ++r) column(row + c)[row + r] += H(r, c);
    b_[index(row + c)] += b(c);
  }
}

void Root::add_interval(int k, const IntervalLinearisation& linear) {
  reserve(extent());
  const int older = row_of_state(k - 1), newer = row_of_state(k);
  const auto place = [&](int i) { return i < state_size_ ? older + i : newer + i - state_size_; };
  const int both = 2 * state_size_;
  for (int c = 0; c < both; ++c) {
    const int at = place(c);
    b_[index(at)] -= linear.gradient(c);
    for (int r = 0; r < both; ++r) {
      if (place(r) >= at) column(at)[place(r)] += linear.states(r, c);
    }
  }
  for (const auto& coupling : linear.couplings) {
    const int row = row_of_slot(slot_of(coupling.landmark));
    add_landmark(coupling.landmark, coupling.landmark_landmark, -coupling.gradient);
    const double* values = coupling.landmark_states.data();
    for (int c = 0; c < both; ++c, values += 3) {
      double* to = column(place(c)) + row;
      to[0] += values[0];
      to[1] += values[1];
      to[2] += values[2];
    }
  }
}

void Root::add_factor(const Eigen::Ref<const Eigen::MatrixXd>& R, const Eigen::Ref<const Eigen::VectorXd>& mean) {
  const int n = static_cast<int>(R.rows());
  as_matrix(H(), n, n, stride_).selfadjointView<Eigen::Lower>().rankUpdate(R);
  as_vector(b(), n).noalias() += R * mean;
}

void Root::add_landmark_factor(std::span<const int> landmarks, const AnchorLinearisation& linear) {
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (slot_of(landmarks[i]) < 0) continue;  // never observed: constant
    const int row = row_of_slot(slot_of(landmarks[i]));
    for (int r = 0; r < 3; ++r) b_[index(row + r)] -= linear.e * linear.jacobian[i](r);
    for (std::size_t j = 0; j < landmarks.size(); ++j) {
      if (slot_of(landmarks[j]) < 0) continue;
      const int at = row_of_slot(slot_of(landmarks[j]));
      for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) {
          if (row + r >= at + c) column(at + c)[row + r] += linear.jacobian[i](r) * linear.jacobian[j](c);
        }
      }
    }
  }
}

void Root::clear() {
  clear_occupants();
  std::ranges::fill(H_, 0.0);
  std::ranges::fill(b_, 0.0);
  reserve(extent());
}

void Root::save(Snapshot& to) const {
  const int n = extent();
  to.top = top_;
  to.occupant.assign(occupant_.begin(), occupant_.begin() + top_);
  to.b.assign(b_.begin(), b_.begin() + n);
  to.H.resize(index(n / kPadding * (n / kPadding + 1) / 2 * kPadding * kPadding));
  double* at = to.H.data();
  for (int c = 0; c < n; ++c) {
    const int first = c / kPadding * kPadding;
    const double* from = column(c);
    at = std::copy(from + first, from + n, at);
  }
}

void Root::Snapshot::shift(int row, int size, const double* shift) {
  const int n = static_cast<int>(b.size());
  const double* column = H.data();  // from the row of its block's first diagonal element on
  for (int c = 0; c < n; ++c) {
    const int first = c / kPadding * kPadding;
    const bool own = c >= row && c < row + size;
    for (int r = c; r < n; ++r) {
      const double value = column[r - first];
      if (own) b[index(r)] -= value * shift[c - row];
      if (r > c && r >= row && r < row + size) b[index(c)] -= value * shift[r - row];
    }
    column += n - first;
  }
}

void Root::restore(const Snapshot& from) {
  const int used = extent();
  clear_occupants();
  top_ = from.top;
  const int n = extent();
  reserve(n);
  if (occupant_.size() < from.occupant.size()) occupant_.resize(from.occupant.size(), -1);
  for (int slot = 0; slot < top_; ++slot) {
    const int landmark = from.occupant[index(slot)];
    occupant_[index(slot)] = landmark;
    if (landmark >= 0) slot_of_[index(landmark)] = slot;
  }
  const double* at = from.H.data();
  for (int c = 0; c < std::max(n, used); ++c) {
    const int first = c / kPadding * kPadding;
    double* to = column(c);
    if (c < n) {
      std::copy(at, at + (n - first), to + first);
      at += n - first;
    }
    if (std::max(first, n) < used) std::fill(to + std::max(first, n), to + used, 0.0);
  }
  std::ranges::copy(from.b, b_.begin());
  if (used > n) std::fill(b_.begin() + n, b_.begin() + used, 0.0);
}

void Root::reserve(int rows) {
  if (rows <= stride_) return;
  // An odd number of cache lines: columns then don't compete for the same cache sets.
  const int stride = (std::max(rows, stride_ + stride_ / 2) / kPadding | 1) * kPadding;
  Buffer H(index(stride) * index(stride), 0.0);
  for (int c = 0; c < stride_; ++c) std::copy(column(c) + c, column(c) + stride_, H.begin() + c * (stride + 1L));
  H_ = std::move(H);
  b_.resize(index(stride), 0.0);
  stride_ = stride;
}

void Root::clear_occupants() {
  for (int slot = 0; slot < top_; ++slot) {
    const int landmark = occupant_[index(slot)];
    if (landmark >= 0) slot_of_[index(landmark)] = -1;
    occupant_[index(slot)] = -1;
  }
  top_ = 0;
}

}  // namespace evbench::smoother
