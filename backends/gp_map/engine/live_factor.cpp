#include "backends/gp_map/engine/live_factor.hpp"

#include <algorithm>
#include <cmath>

#include "backends/gp_map/engine/conditional.hpp"
#include "backends/gp_map/engine/lanes.hpp"

namespace evbench::gp_map {
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

bool LiveFactor::build(const Root& root, int newest, const IntervalLinearisation& motion) {
  const int landmark_rows = 3 * root.slots();
  const int older = Root::row_of_state(newest - 1);
  const std::ptrdiff_t from = root.stride();
  const double* H = root.H();
  states_row_ = landmark_rows;
  size_ = padded(landmark_rows + 24);
  stride_ = size_ + kPadding;
  newest_ = -1;
  L_.assign(static_cast<std::size_t>(size_) * static_cast<std::size_t>(stride_), 0.0);
  Buffer y(static_cast<std::size_t>(size_), 0.0);
  for (int c = 0; c < landmark_rows; ++c) {
    const double* source = H + (Root::kStates + c) * from + Root::kStates;
    std::copy(source + c, source + landmark_rows, column(c) + c);
    for (int r = 0; r < 12; ++r) column(c)[landmark_rows + r] = H[(older + r) * from + Root::kStates + c];
    if (root.occupant(c / 3) < 0) column(c)[c] = 1.0;
    y[static_cast<std::size_t>(c)] = root.b()[Root::kStates + c];
  }
  for (int c = 0; c < 24; ++c) {
    for (int r = c; r < 24; ++r) {
      const double old = c < 12 && r < 12 ? H[(older + c) * from + older + r] : 0.0;
      column(landmark_rows + c)[landmark_rows + r] = old + motion.states(r, c);
    }
    y[static_cast<std::size_t>(landmark_rows + c)] = (c < 12 ? root.b()[older + c] : 0.0) - motion.gradient(c);
  }
  for (const auto& coupling : motion.couplings) {
    if (root.slot_of(coupling.landmark) < 0) continue;
    const int row = 3 * root.slot_of(coupling.landmark);
    for (int c = 0; c < 3; ++c) {
      for (int r = c; r < 3; ++r) column(row + c)[row + r] += coupling.landmark_landmark(r, c);
      for (int r = 0; r < 24; ++r) column(row + c)[landmark_rows + r] += coupling.landmark_states(c, r);
      y[static_cast<std::size_t>(row + c)] -= coupling.gradient(c);
    }
  }
  for (int i = landmark_rows + 24; i < size_; ++i) column(i)[i] = 1.0;
  if (cholesky_blocked(L_.data(), stride_, size_, kPivotTolerance) >= 0) return false;
  solve_lower(L_.data(), stride_, size_, y.data());
  for (int c = 0; c < size_; ++c) column(c)[size_] = y[static_cast<std::size_t>(c)];
  newest_ = newest;
  return true;
}

void LiveFactor::add(int slot, const ObservationRows& rows, double weight) {
  const double scale = std::sqrt(weight);
  v_.assign(static_cast<std::size_t>(stride_), 0.0);
  w_.assign(static_cast<std::size_t>(stride_), 0.0);
  double* v = v_.data();
  double* w = w_.data();
  for (int i = 0; i < 3; ++i) {
    v[3 * slot + i] = scale * rows.landmark(0, i);
    w[3 * slot + i] = scale * rows.landmark(1, i);
  }
  for (int i = 0; i < 24; ++i) {
    v[states_row_ + i] = scale * rows.states(0, i);
    w[states_row_ + i] = scale * rows.states(1, i);
  }
  v[size_] = -scale * rows.e(0);
  w[size_] = -scale * rows.e(1);
  for (int k = 3 * slot; k < states_row_ + 24; ++k) {
    double* L = column(k);
    const Rotation a(L[k], v[k]);
    const Rotation b(L[k], w[k]);
    for (int i = k + 1; i <= size_; i += kLanes) {  // the padding beyond is zero
      if (i + kLanes > stride_) {
        for (int r = i; r <= size_; ++r) {
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

Vector24 LiveFactor::solve_states() const {
  Vector24 x;
  for (int k = 23; k >= 0; --k) {
    const double* L = column(states_row_ + k);
    double value = L[size_];
    for (int r = k + 1; r < 24; ++r) value -= L[states_row_ + r] * x(r);
    x(k) = value / L[states_row_ + k];
  }
  return x;
}

}  // namespace evbench::gp_map
