#include "core/smoother/engine/live_factor.hpp"

#include <algorithm>
#include <cmath>

#include "core/smoother/engine/lanes.hpp"
#include "core/support/index.hpp"

namespace evbench::smoother {
namespace {

/// The rotation that takes v into the pivot: L ← (L + s v)/c, v ← c v − s L for the column below.
struct Rotation {
  double c = 1.0, inverse_c = 1.0, s = 0.0;
  Rotation(double& pivot, double v) {
    const double r = std::hypot(pivot, v);
    c = r / pivot;
    inverse_c = pivot / r;
    s = v / pivot;
    pivot = r;
  }
};

}  // namespace

bool LiveFactor::build(const Root& root, int newest, const IntervalLinearisation& open) {
  newest_ = -1;
  occupants_.clear();
  for (int slot = 0; slot < root.slots(); ++slot) occupants_.push_back(root.occupant(slot));
  factor_.load(root, newest - 1, 2);
  state_rows_ = 2 * root.state_size();
  const int states = factor_.row_of_states();
  for (int c = 0; c < state_rows_; ++c) {
    for (int r = c; r < state_rows_; ++r) factor_.column(states + c)[states + r] += open.states(r, c);
    factor_.b()[states + c] -= open.gradient(c);
  }
  for (const auto& coupling : open.couplings) {
    if (!has(coupling.landmark)) continue;
    const int row = factor_.row_of_slot(slot_of(coupling.landmark));
    for (int c = 0; c < 3; ++c) {
      double* column = factor_.column(row + c);
      for (int r = c; r < 3; ++r) column[row + r] += coupling.landmark_landmark(r, c);
      for (int r = 0; r < state_rows_; ++r) column[states + r] += coupling.landmark_states(c, r);
      factor_.b()[row + c] -= coupling.gradient(c);
    }
  }
  if (factor_.factorise() >= 0) return false;
  factor_.solve_forward(factor_.b());
  for (int c = 0; c < factor_.size(); ++c) factor_.column(c)[factor_.size()] = factor_.b()[c];
  newest_ = newest;
  return true;
}

void LiveFactor::add(int landmark, const ObservationRows& rows, double weight) {
  if (rows.states.cols() == 0) return;
  const double scale = std::sqrt(weight);
  const int size = factor_.size(), stride = factor_.stride();
  const int first = factor_.row_of_slot(slot_of(landmark)), states = factor_.row_of_states();
  v_.assign(index(stride), 0.0);
  w_.assign(index(stride), 0.0);
  double* v = v_.data();
  double* w = w_.data();
  for (int i = 0; i < 3; ++i) {
    v[first + i] = scale * rows.landmark(0, i);
    w[first + i] = scale * rows.landmark(1, i);
  }
  for (int i = 0; i < state_rows_; ++i) {
    v[states + i] = scale * rows.states(0, i);
    w[states + i] = scale * rows.states(1, i);
  }
  v[size] = -scale * rows.e(0);
  w[size] = -scale * rows.e(1);
  for (int k = first; k < states + state_rows_; ++k) {
    double* L = factor_.column(k);
    const Rotation a(L[k], v[k]);
    const Rotation b(L[k], w[k]);
    for (int i = k + 1; i <= size; i += kLanes) {  // the padding beyond is zero
      if (i + kLanes > stride) {
        for (int r = i; r <= size; ++r) {
          L[r] = (L[r] + a.s * v[r]) * a.inverse_c;
          v[r] = a.c * v[r] - a.s * L[r];
          L[r] = (L[r] + b.s * w[r]) * b.inverse_c;
          w[r] = b.c * w[r] - b.s * L[r];
        }
        break;
      }
      const Lane l = (load(L + i) + a.s * load(v + i)) * a.inverse_c;
      store(v + i, a.c * load(v + i) - a.s * l);
      const Lane m = (l + b.s * load(w + i)) * b.inverse_c;
      store(w + i, b.c * load(w + i) - b.s * m);
      store(L + i, m);
    }
  }
}

PairVector LiveFactor::solve_states() const {
  const int states = factor_.row_of_states();
  const auto rows = as_matrix(factor_.column(states), factor_.stride(), state_rows_, factor_.stride());
  PairVector x = rows.row(factor_.size()).transpose();
  rows.middleRows(states, state_rows_).transpose().triangularView<Eigen::Upper>().solveInPlace(x);
  return x;
}

}  // namespace evbench::smoother
