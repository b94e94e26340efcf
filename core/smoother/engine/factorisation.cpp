#include "core/smoother/engine/factorisation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace evbench::smoother {
namespace {

/// Spacing of the stored snapshots of the root by their age in stages: most restarts go back a few stages, and memory
/// must grow slowly with the length of the history.
int snapshot_spacing(int age) {
  if (age < 8) return 2;
  if (age < 32) return 4;
  return age < 128 ? 8 : 64;
}

}  // namespace

std::string Variable::name() const { return fmt::format("{} {}", kind == Kind::state ? "state" : "landmark", index); }

int Factorisation::Stage::pivots() const {
  int sum = 0;
  for (const Conditional& c : conditionals) sum += c.pivots;
  return sum;
}

void Factorisation::Stage::eliminate(double* r, int r_stride, double* z, int columns) const {
  const int z_stride = pivots();
  for (const Conditional& c : conditionals) {
    c.eliminate(r, r_stride, z, z_stride, columns);
    z += c.pivots;
  }
}

void Factorisation::Stage::back_substitute(const double* z, double* delta) const {
  z += pivots();
  for (auto c = conditionals.rbegin(); c != conditionals.rend(); ++c) {
    z -= c->pivots;
    c->back_substitute(z, delta);
  }
}

void Factorisation::Stage::back_substitute(double* z, double* x, int x_stride, int columns) const {
  const int z_stride = pivots();
  z += z_stride;
  for (auto c = conditionals.rbegin(); c != conditionals.rend(); ++c) {
    z -= c->pivots;
    c->back_substitute(z, z_stride, x, x_stride, columns);
  }
}

void Factorisation::add_landmark() { landmarks_.emplace_back(); }

std::optional<int> Factorisation::eliminated_at(int j) const {
  const int stage = landmarks_[index(j)].eliminated_at;
  if (stage < 0 || stage > done_ || root_.slot_of(j) >= 0) return std::nullopt;
  return stage;
}

void Factorisation::regularise(const Variable& variable) {
  if (variable.kind == Variable::Kind::landmark) {
    landmarks_[index(variable.index)].regularised = true;
  } else {
    if (regularised_states_.size() <= index(variable.index))
      regularised_states_.resize(index(variable.index) + 1, false);
    regularised_states_[index(variable.index)] = true;
  }
}

bool Factorisation::is_regularised(const Variable& variable) const {
  const std::size_t i = index(variable.index);
  if (variable.kind == Variable::Kind::landmark) return landmarks_[i].regularised;
  return i < regularised_states_.size() && regularised_states_[i];
}

std::optional<Variable> Factorisation::redo(int first, const FactorGraph& graph, LinearisationPoints& points,
                                            double damping) {
  const int newest = static_cast<int>(graph.states.size()) - 1;
  if (done_ > newest) first = std::min(first, newest + 1);  // states were removed
  first = std::min(first, update_anchor_stage(graph));
  first = go_back_to(first, graph);
  stages_.resize(graph.states.size());
  while (const std::optional<int> earlier = bring_all_back(graph, points)) {
    first = std::min(first, go_back_to(*earlier, graph));
  }
  if (returns_.first_after(done_) < returns_.size()) first = done_ + 1;
  for (int k = done_ + 1; k <= newest; ++k) {
    if (const auto singular = do_stage(k, graph, points, damping)) {
      done_ = k;  // later stages are unusable, and this one must be redone
      go_back_to(k, graph);
      return singular;
    }
    done_ = k;
    if (k >= first) stage(k).skipped = std::numeric_limits<double>::infinity();
    keep_snapshot(k, newest);
  }
  thin_snapshots(newest);
  returns_.thin(newest - kThinnedUpTo);
  return std::nullopt;
}

/// Finds the stage that adds the scale anchor; none once the anchor is part of the base. Returns the oldest stage that
/// must be redone for it: the anchor may have moved between two stages that have not changed themselves.
int Factorisation::update_anchor_stage(const FactorGraph& graph) {
  const int before = anchor_stage_;
  anchor_stage_ = -1;
  for (const int j : graph.anchor.landmarks) {
    const auto& seen = graph.landmarks[index(j)].intervals;
    if (!seen.empty() && !anchor_in_base_) anchor_stage_ = std::max(anchor_stage_, seen.front());
  }
  if (anchor_stage_ == before) return done_ + 1;
  const int older = std::min(before, anchor_stage_);
  return std::max(base_ + 1, older < 0 ? std::max(before, anchor_stage_) : older);
}

/// Resets the root to its content before stage `first` or an earlier one. Returns the oldest stage that will change: an
/// older one if landmarks have moved.
int Factorisation::go_back_to(int first, const FactorGraph& graph) {
  if (first > done_) return first;
  const int before = done_;
  const auto after = snapshots_.lower_bound(first);
  for (auto i = after; i != snapshots_.end(); ++i) spare_.push_back(std::move(i->second));
  snapshots_.erase(after, snapshots_.end());
  if (snapshots_.empty()) {
    root_.clear();
    done_ = -1;
  } else {
    root_.restore(snapshots_.rbegin()->second);
    done_ = snapshots_.rbegin()->first;
  }
  // The redone stages may not contain these landmarks again: their observations may be gone.
  for (int k = done_ + 1; k <= before; ++k) {
    for (const Conditional& conditional : stage(k).conditionals) {
      for (const int j : conditional.landmarks) {
        if (landmarks_[index(j)].eliminated_at == k) landmarks_[index(j)].eliminated_at = -1;
      }
    }
  }
  const int oldest = take_back_returns(graph);
  return oldest <= done_ ? go_back_to(oldest, graph) : first;
}

int Factorisation::snapshot_before(int first) const {
  if (first > done_) return done_;
  const auto snapshot = snapshots_.lower_bound(first);
  return snapshot == snapshots_.begin() ? -1 : std::prev(snapshot)->first;
}

std::optional<Variable> Factorisation::do_stage(int k, const FactorGraph& graph, LinearisationPoints& points,
                                                double damping) {
  ++stages_done_;
  stage(k).entered.clear();
  stage(k).entered_slots.clear();
  stage(k).moved.clear();
  stage(k).returned.clear();
  add_factors(k, graph, points);
  if (k == 0) return std::nullopt;
  find_finished(k, graph);
  return eliminate_finished(k, points, damping);
}

void Factorisation::add_factors(int k, const FactorGraph& graph, LinearisationPoints& points) {
  const StateSystem priors = state_priors(graph, k, points.state(k));
  root_.add_state(k, priors.H, -priors.g);
  if (k == 0) return;
  const IntervalLinearisation& linear = points.interval(graph, k);
  std::vector<int>& entered = stage(k).entered;
  for (const auto& coupling : linear.couplings) {
    if (root_.slot_of(coupling.landmark) >= 0) continue;
    enter(coupling.landmark, graph, points);
    entered.push_back(coupling.landmark);
  }
  root_.close_holes(stage(k).moved);
  for (const int j : entered) stage(k).entered_slots.push_back(root_.slot_of(j));
  root_.add_interval(k, linear);
  if (k == anchor_stage_) add_anchor(graph, points);
}

void Factorisation::enter(int j, const FactorGraph& graph, const LinearisationPoints& points) {
  root_.enter(j);
  landmarks_[index(j)].eliminated_at = -1;
  const LandmarkPrior& prior = graph.landmarks[index(j)].prior;
  if (!std::isfinite(prior.sigma)) return;
  const double information = 1.0 / (prior.sigma * prior.sigma);
  root_.add_landmark(j, information * Matrix3::Identity(), information * (prior.position - points.landmark(j)));
}

void Factorisation::add_anchor(const FactorGraph& graph, const LinearisationPoints& points) {
  AnchorLinearisation linear = linearise_anchor(graph);  // at the estimate: e(δ) = e + J (δ − δ_now)
  for (std::size_t i = 0; i < graph.anchor.landmarks.size(); ++i) {
    linear.e -= linear.jacobian[i].dot(points.landmark_delta(graph.anchor.landmarks[i]));
  }
  root_.add_landmark_factor(graph.anchor.landmarks, linear);
}

void Factorisation::find_finished(int k, const FactorGraph& graph) {
  const int newest = static_cast<int>(graph.states.size()) - 1;
  finished_.clear();
  for (int slot = 0; slot < root_.slots(); ++slot) {
    const int j = root_.occupant(slot);
    if (j < 0) continue;
    const int last = last_interval(j, graph);
    if (last > k || newest - last < grace_) continue;
    if (k < anchor_stage_ && std::ranges::find(graph.anchor.landmarks, j) != graph.anchor.landmarks.end()) continue;
    finished_.push_back(j);
  }
}

std::optional<Variable> Factorisation::eliminate_finished(int k, const LinearisationPoints& points, double damping) {
  for (const int j : finished_) damp({Variable::Kind::landmark, j}, points, damping);
  damp({Variable::Kind::state, k - 1}, points, damping);
  Stage& stage = stages_[index(k)];
  std::span<const int> rest = finished_;
  stage.conditionals.resize(rest.size() / kMaxPivotLandmarks + 1);  // not cleared: their memory is reused
  for (Conditional& conditional : stage.conditionals) {
    const bool last = &conditional == &stage.conditionals.back();
    const auto chunk = rest.first(last ? rest.size() : kMaxPivotLandmarks);
    rest = rest.subspan(chunk.size());
    const int failed = eliminate(root_, chunk, last ? k - 1 : -1, conditional);
    if (failed == static_cast<int>(chunk.size())) return Variable{Variable::Kind::state, k - 1};
    if (failed >= 0) return Variable{Variable::Kind::landmark, chunk[index(failed)]};
    for (const int j : chunk) landmarks_[index(j)].eliminated_at = k;
  }
  return std::nullopt;
}

double Factorisation::damping_of(const Variable& variable, double damping) const {
  return is_regularised(variable) ? std::max(damping, kRegularisingDamping) : damping;
}

void Factorisation::damp(const Variable& variable, const LinearisationPoints& points, double damping) {
  const double lambda = damping_of(variable, damping);
  if (lambda == 0.0) return;
  if (variable.kind == Variable::Kind::state) {
    root_.damp(root_.row_of_state(variable.index), root_.state_size(), lambda,
               points.state_delta(variable.index).data());
  } else {
    const int row = root_.row_of_slot(root_.slot_of(variable.index));
    root_.damp(row, 3, lambda, points.landmark_delta(variable.index).data());
  }
}

std::optional<Variable> Factorisation::factorise_root(const LinearisationPoints& points, double damping) {
  factor_.load(root_, done_, 1);
  const auto damp = [&](const Variable& variable, int row, int rows, const double* now) {
    const double lambda = damping_of(variable, damping);
    if (lambda > 0.0) factor_.damp(row, rows, lambda, now);
  };
  for (int slot = 0; slot < root_.slots(); ++slot) {
    const int j = root_.occupant(slot);
    if (j < 0) continue;
    damp({Variable::Kind::landmark, j}, factor_.row_of_slot(slot), 3, points.landmark_delta(j).data());
  }
  const Variable state{Variable::Kind::state, done_};
  damp(state, factor_.row_of_states(), root_.state_size(), points.state_delta(done_).data());
  const int failed = factor_.factorise();
  if (failed >= factor_.row_of_states()) return state;
  if (failed >= 0) return Variable{Variable::Kind::landmark, root_.occupant(failed / 3)};
  return std::nullopt;
}

void Factorisation::solve_root(Buffer& delta) {
  if (static_cast<int>(delta.size()) < root_.stride()) delta.resize(index(root_.stride()), 0.0);
  factor_.solve_forward(factor_.b());
  factor_.solve_back(factor_.b());
  factor_.copy_to_root(factor_.b(), delta.data());
  back_.start(returns_);
  back_.cross(returns_, done_ + 1, delta.data());
}

void Factorisation::solve_stage(int k, double* delta) {
  const Stage& stage = stages_[index(k)];
  right_hand_side_.clear();
  for (const Conditional& c : stage.conditionals) {
    right_hand_side_.insert(right_hand_side_.end(), c.y.begin(), c.y.end());
  }
  back_.shift(stage.returned, right_hand_side_.data(), stage.pivots());
  stage.back_substitute(right_hand_side_.data(), delta);
  root_.undo_moves(stage.moved, delta, 0, 1);
  back_.cross(returns_, k, delta);
}

void Factorisation::keep_snapshot(int k, int newest) {
  if (k % snapshot_spacing(newest - k) != 0) return;
  Root::Snapshot snapshot;
  if (!spare_.empty()) {
    snapshot = std::move(spare_.back());
    spare_.pop_back();
  }
  root_.save(snapshot);
  snapshots_[k] = std::move(snapshot);
}

void Factorisation::thin_snapshots(int newest) {
  for (auto i = snapshots_.lower_bound(newest - kThinnedUpTo); i != snapshots_.end();) {
    if (i->first == base_ || i->first % snapshot_spacing(newest - i->first) == 0) {
      ++i;
    } else {
      if (spare_.size() < 16) spare_.push_back(std::move(i->second));
      i = snapshots_.erase(i);
    }
  }
}

/// All intervals of a landmark in the base may have been marginalised or removed.
int Factorisation::last_interval(int j, const FactorGraph& graph) const {
  const auto& seen = graph.landmarks[index(j)].intervals;
  return seen.empty() ? base_ : seen.back();
}

int Factorisation::marginalise(int stage) {
  auto snapshot = snapshots_.upper_bound(std::min(stage, done_));
  if (snapshot == snapshots_.begin() || (--snapshot)->first <= base_) return base_;
  for (int k = base_ + 1; k <= snapshot->first; ++k) {
    for (const Conditional& conditional : stages_[index(k)].conditionals) {
      for (const int j : conditional.landmarks) landmarks_[index(j)].marginalised = true;
    }
    stages_[index(k)] = Stage();
  }
  for (auto i = snapshots_.begin(); i != snapshot; ++i) spare_.push_back(std::move(i->second));
  snapshots_.erase(snapshots_.begin(), snapshot);
  base_ = snapshot->first;
  if (anchor_stage_ >= 0 && anchor_stage_ <= base_) {
    anchor_in_base_ = true;
    anchor_stage_ = -1;
  }
  return base_;
}

int Factorisation::row_in_base(const Variable& variable) const {
  if (base_ < 0) return -1;
  if (variable.kind == Variable::Kind::state) return variable.index == base_ ? root_.row_of_state(base_) : -1;
  const auto& occupants = snapshots_.begin()->second.occupant;
  const auto found = std::ranges::find(occupants, variable.index);
  return found == occupants.end() ? -1 : root_.row_of_slot(static_cast<int>(found - occupants.begin()));
}

bool Factorisation::in_base(const Variable& variable) const { return row_in_base(variable) >= 0; }

void Factorisation::shift_base(const Variable& variable, const double* shift) {
  const int row = row_in_base(variable);
  const int size = variable.kind == Variable::Kind::state ? root_.state_size() : 3;
  if (row >= 0) snapshots_.begin()->second.shift(row, size, shift);
}

}  // namespace evbench::smoother
