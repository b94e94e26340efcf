#include <algorithm>

#include "backends/gp_map/engine/factorisation.hpp"

// The root's own factor: landmarks first, the newest state last; places that nobody has get a unit diagonal.
namespace evbench::gp_map {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// The root's lower triangle in the order of the factor.
void copy_lower(const Root& root, int landmark_rows, int state_row, double* F, std::ptrdiff_t n) {
  const std::ptrdiff_t stride = root.stride();
  const double* H = root.H();
  for (int c = 0; c < landmark_rows; ++c) {
    const double* from = H + (Root::kStates + c) * stride + Root::kStates;
    std::copy(from + c, from + landmark_rows, F + c * n + c);
    for (int r = 0; r < 12; ++r) F[c * n + landmark_rows + r] = H[(state_row + r) * stride + Root::kStates + c];
  }
  for (int c = 0; c < 12; ++c) {
    for (int r = c; r < 12; ++r) {
      F[(landmark_rows + c) * n + landmark_rows + r] = H[(state_row + c) * stride + state_row + r];
    }
  }
}

}  // namespace

std::optional<Variable> Factorisation::factorise_root(const LinearisationPoints& points, double damping) {
  const int state_row = Root::row_of_state(done_);
  const int landmark_rows = 3 * root_.slots();
  factor_slots_ = root_.slots();
  factor_size_ = padded(landmark_rows + 12);
  const std::ptrdiff_t n = factor_size_;
  factor_.resize(at(factor_size_) * at(factor_size_));
  solution_.assign(at(factor_size_), 0.0);
  double* F = factor_.data();
  double* x = solution_.data();
  copy_lower(root_, landmark_rows, state_row, F, n);
  std::copy_n(root_.b() + Root::kStates, landmark_rows, x);
  std::copy_n(root_.b() + state_row, 12, x + landmark_rows);
  const auto damp = [&](int row, int rows, double lambda, const double* now) {
    if (lambda > 0.0) add_damping(F, n, x, row, rows, lambda, now);
  };
  for (int slot = 0; slot < root_.slots(); ++slot) {
    const int j = root_.occupant(slot);
    if (j < 0) {
      for (int i = 3 * slot; i < 3 * slot + 3; ++i) F[i * (n + 1)] = 1.0;
    } else {
      damp(3 * slot, 3, is_held({Variable::Kind::landmark, j}) ? std::max(damping, kHoldDamping) : damping,
           points.landmark_delta(j).data());
    }
  }
  damp(landmark_rows, 12, is_held({Variable::Kind::state, done_}) ? std::max(damping, kHoldDamping) : damping,
       points.state_delta(done_).data());
  for (int c = 0; c < factor_size_; ++c) {
    std::fill(F + c * n + std::max(c, landmark_rows + 12), F + (c + 1) * n, 0.0);
    if (c >= landmark_rows + 12) F[c * (n + 1)] = 1.0;
  }
  const int failed = cholesky_blocked(F, factor_size_, factor_size_, kPivotTolerance);
  if (failed >= landmark_rows) return Variable{Variable::Kind::state, done_};
  if (failed >= 0) return Variable{Variable::Kind::landmark, root_.occupant(failed / 3)};
  solve_lower(F, factor_size_, factor_size_, x);
  solve_lower_transposed(F, factor_size_, factor_size_, x);
  return std::nullopt;
}

void Factorisation::solve_root(Buffer& delta) const {
  if (static_cast<int>(delta.size()) < root_.stride()) delta.resize(at(root_.stride()), 0.0);
  std::copy_n(solution_.data(), 3 * factor_slots_, delta.data() + Root::kStates);
  std::copy_n(solution_.data() + 3 * factor_slots_, 12, delta.data() + Root::row_of_state(done_));
}

void Factorisation::solve_with_root_factor(double* x) const {
  Buffer y(at(factor_size_), 0.0);
  double* state = x + Root::row_of_state(done_);
  std::copy_n(x + Root::kStates, 3 * factor_slots_, y.data());
  std::copy_n(state, 12, y.data() + 3 * factor_slots_);
  solve_lower(factor_.data(), factor_size_, factor_size_, y.data());
  solve_lower_transposed(factor_.data(), factor_size_, factor_size_, y.data());
  std::copy_n(y.data(), 3 * factor_slots_, x + Root::kStates);
  std::copy_n(y.data() + 3 * factor_slots_, 12, state);
}

std::optional<std::pair<int, int>> Factorisation::find_landmark(int j) const {
  if (root_.slot_of(j) >= 0) return std::pair(done_ + 1, Root::row_of_slot(root_.slot_of(j)));
  const std::optional<int> stage = eliminated_at(j);
  if (!stage) return std::nullopt;
  for (const Conditional& conditional : stages_[at(*stage)].conditionals) {
    const auto found = std::ranges::find(conditional.landmarks, j);
    if (found == conditional.landmarks.end()) continue;
    return std::pair(*stage, conditional.rows[static_cast<std::size_t>(found - conditional.landmarks.begin())]);
  }
  return std::nullopt;
}

}  // namespace evbench::gp_map
