#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/solve_symmetric.hpp"
#include "core/smoother/engine/engine.hpp"
#include "core/smoother/engine/landmark_views.hpp"

// The part of the engine that turns a factorisation into increments and decides whether to accept them.
namespace evbench::smoother {
namespace {

/// Line search along `step`: returns the share of it that lowers the landmark's own cost below `cost`, found by
/// halving, or 0 if none does. Updates `cost`.
double descend(const LandmarkViews& views, const Vector3& start, const Vector3& step, double share, double& cost) {
  constexpr int kHalvings = 6;
  for (int i = 0; i < kHalvings; ++i, share *= 0.5) {
    const double after = views.cost(start + share * step);
    if (after > cost || !std::isfinite(after)) continue;
    cost = after;
    return share;
  }
  return 0.0;
}

/// Moves a landmark along `step`, then by Gauss-Newton steps, while its own cost decreases. `size`: of the step,
/// relative to the landmark's distance.
Vector3 refine_landmark(const LandmarkViews& views, Vector3 position, const Vector3& step, double size) {
  constexpr double kLargestStep = 0.3;
  constexpr int kIterations = 2;
  double cost = views.cost(position);
  position += descend(views, position, step, std::min(1.0, kLargestStep / size), cost) * step;
  for (int i = 0; i < kIterations; ++i) {
    const LandmarkViews::System system = views.linearise(position);
    const Vector3 next = -solve_symmetric(system.H, system.g);
    if (!next.allFinite() || next.norm() > kLargestStep / size * step.norm()) break;
    position += descend(views, position, next, 1.0, cost) * next;
  }
  return position;
}

}  // namespace

void Engine::set_state_increment(int i, const double* delta) {
  const StateVector now = as_vector(delta, graph_.state_size());
  const StateVector before = points_.state_delta(i);
  state_change_ = size_of_state(i, now - before);
  changes_.push_back({{Variable::Kind::state, i}, before, state_change_});
  points_.set_state_delta(graph_, i, now);
}

void Engine::set_landmark_increment(int j, const double* delta, int slot) {
  const Vector3 now = Eigen::Map<const Vector3>(delta);
  const Vector3 before = points_.landmark_delta(j);
  const double size = size_of_landmark(j, now - before);
  slot_change_[index(slot)] = size;
  changes_.push_back({{Variable::Kind::landmark, j}, before, size});
  points_.set_landmark_delta(graph_, j, now);
}

/// Older stages are solved again when returned landmarks change the mean of their noise by more than this [standard
/// deviations of that noise]. In cost this is worth as much as `solve_tolerance`.
constexpr double kNoiseTolerance = 0.3;

/// Deferred changes below this wait for a later update [multiples of the tolerance].
constexpr double kSmall = 30.0;

/// Solves back from the root through the stages. All redone stages are solved. Older stages are solved while the change
/// of their separator, summed over the updates since the stage was last solved, exceeds the tolerance; this bounds the
/// skipped change over any number of updates. Beyond depth_ stages small changes are deferred to an update that reaches
/// farther back, because every returned landmark changes the whole history a little. After a deferral the changes of
/// the separators are unknown, so all stages are solved.
void Engine::solve_back(UpdateSummary& summary) {
  const Root& root = factorisation_.root();
  const int newest = factorisation_.done();
  slot_change_.assign(index(root.slot_of_row(root.stride()) + 1), 0.0);
  set_state_increment(newest, delta_.data() + root.row_of_state(newest));
  int landmarks = 0;
  for (int slot = 0; slot < root.slots(); ++slot) {
    if (root.occupant(slot) < 0) continue;
    set_landmark_increment(root.occupant(slot), delta_.data() + root.row_of_slot(slot), slot);
    ++landmarks;
  }
  clear_returns(newest + 1);
  // Small changes of poses change accelerations, and velocities between states, by much of their standard deviations.
  const double share = graph_.motion_prior.has_acceleration() ? 0.25 : 1.0;
  const double tolerance = share * options_.solve_tolerance / std::sqrt(std::max(1, landmarks));
  for (int k = newest; k > std::max(0, factorisation_.base()); --k) {
    Factorisation::Stage& stage = factorisation_.stage(k);
    stage.skipped += separator_change(k) + tolerance / kNoiseTolerance * factorisation_.change_by_returns();
    if (stage.skipped < tolerance && waiting_ == 0.0) break;
    if (newest - k >= depth_ && std::isfinite(stage.skipped)) {
      waiting_ += stage.skipped;
      if (waiting_ < kSmall * tolerance) return;
    }
    stage.skipped = 0.0;
    ++summary.solved_back;
    factorisation_.solve_stage(k, delta_.data());
    for (const Conditional& conditional : stage.conditionals) {
      for (std::size_t i = 0; i < conditional.landmarks.size(); ++i) {
        const int j = conditional.landmarks[i], row = conditional.rows[i], slot = root.slot_of_row(row);
        if (factorisation_.eliminated_at(j) == k) {
          set_landmark_increment(j, delta_.data() + row, slot);
        } else {
          Vector3& before = factorisation_.returns().find(j, k)->delta_before;  // the landmark returned later
          const Vector3 now = Eigen::Map<const Vector3>(delta_.data() + row);
          slot_change_[index(slot)] = size_of_landmark(j, now - std::exchange(before, now));
        }
      }
      if (conditional.state >= 0) set_state_increment(conditional.state, delta_.data() + conditional.rows.back());
    }
    for (const int slot : stage.entered_slots) slot_change_[index(slot)] = 0.0;
    for (auto move = stage.moved.rbegin(); move != stage.moved.rend(); ++move) {
      slot_change_[index(move->from)] = std::exchange(slot_change_[index(move->to)], 0.0);
    }
    clear_returns(k);
  }
  waiting_ = 0.0;
}

/// Landmarks that returned before stage k have no slot in the layout before it.
void Engine::clear_returns(int k) {
  const Returns& returns = factorisation_.returns();
  for (int i = returns.first_after(k - 1); i < returns.size() && returns[i].before == k; ++i) {
    slot_change_[index(returns[i].slot)] = 0.0;
  }
}

/// The largest change in the separator of stage k: state k and the landmarks alive after it.
double Engine::separator_change(int k) const {
  const int slots = factorisation_.root().slot_of_row(factorisation_.stage(k).conditionals.back().extent);
  double change = state_change_;
  for (int slot = 0; slot < slots; ++slot) change = std::max(change, slot_change_[index(slot)]);
  return change;
}

/// Refines each landmark with a large change by itself, with the present poses fixed: a line search along its step by
/// its own cost, then Gauss-Newton steps of 3 unknowns. A landmark seen with little parallax easily overshoots, even to
/// behind the camera. Unlike damping, this needs no new factorisation. The result becomes its linearisation point in
/// the next update.
void Engine::refine_landmarks() {
  for (Change& change : changes_) {
    const int j = change.variable.index;
    if (change.variable.kind != Variable::Kind::landmark || !(change.size > options_.check_step)) continue;
    if (factorisation_.in_base(change.variable)) continue;  // its own cost is no longer known
    const Vector3 before = change.before.head<3>();
    const Vector3 start = points_.landmark(j) + before;
    const Vector3 step = points_.landmark_delta(j) - before;
    const Vector3 refined = refine_landmark(LandmarkViews(graph_, j), start, step, change.size);
    points_.set_landmark_delta(graph_, j, refined - points_.landmark(j));
    refined_.push_back(change.variable);
  }
}

/// Did the last solve raise the cost of the intervals around states with a large change? Elsewhere the linear model is
/// accurate enough: the thresholds of relinearisation ensure this.
bool Engine::raises_cost() {
  concerned_.clear();
  const int newest = static_cast<int>(graph_.states.size()) - 1;
  for (const Change& change : changes_) {
    if (!std::isfinite(change.size)) return true;
    if (change.size <= options_.check_step || change.variable.kind != Variable::Kind::state) continue;
    concerned_.push_back(std::max(1, change.variable.index));
    concerned_.push_back(std::min(newest, change.variable.index + 1));
  }
  if (concerned_.empty() || newest == 0) return false;
  std::ranges::sort(concerned_);
  concerned_.erase(std::unique(concerned_.begin(), concerned_.end()), concerned_.end());
  const double after = concerned_cost(concerned_);
  swap_changes();
  const double before = concerned_cost(concerned_);
  swap_changes();
  constexpr double kRounding = 1e-9;
  return !(after <= before * (1.0 + kRounding));
}

/// The cost of some intervals plus the priors of all changed variables.
double Engine::concerned_cost(const std::vector<int>& intervals) const {
  double cost = 0.0;
  for (const int k : intervals) cost += interval_cost(graph_, k);
  for (const Change& change : changes_) {
    if (change.variable.kind == Variable::Kind::landmark) {
      const FactorGraph::Landmark& landmark = graph_.landmarks[index(change.variable.index)];
      cost += 0.5 * residual(landmark.prior, landmark.position).squaredNorm();
    } else {
      cost += state_prior_cost(graph_, change.variable.index);
    }
  }
  return cost;
}

/// Exchanges the increments with those before the last solve. Each variable is in changes_ once.
void Engine::swap_changes() {
  factorisation_.swap_known();
  for (Change& change : changes_) {
    const int i = change.variable.index;
    if (change.variable.kind == Variable::Kind::state) {
      const StateVector now = points_.state_delta(i);
      points_.set_state_delta(graph_, i, change.before);
      change.before = now;
    } else {
      const Vector3 now = points_.landmark_delta(i);
      points_.set_landmark_delta(graph_, i, change.before.head<3>());
      change.before.head<3>() = now;
    }
  }
}

/// Halves the step of the last solve.
void Engine::halve_changes() {
  for (const Change& change : changes_) {
    const int i = change.variable.index;
    if (change.variable.kind == Variable::Kind::state) {
      points_.set_state_delta(graph_, i, 0.5 * (change.before + points_.state_delta(i)));
    } else {
      points_.set_landmark_delta(graph_, i, 0.5 * (change.before.head<3>() + points_.landmark_delta(i)));
    }
  }
}

}  // namespace evbench::smoother
