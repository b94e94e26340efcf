#include <algorithm>
#include <cmath>
#include <utility>

#include "backends/gp_map/engine/engine.hpp"
#include "backends/gp_map/engine/landmark_views.hpp"
#include "core/geometry/solve_symmetric.hpp"

// The part of the engine that turns a factorisation into increments and decides whether to accept them.
namespace evbench::gp_map {
namespace {

/// The share of `step` that lowers the landmark's own cost below `cost`, tried by halving; 0: none. Lowers `cost`.
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

/// `size`: of the step, relative to the landmark's distance.
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

void Engine::set_state(int i, const double* delta) {
  const Vector12 now = Eigen::Map<const Vector12>(delta);
  const Vector12 before = points_.state_delta(i);
  state_change_ = size_of_state(i, now - before);
  changes_.push_back({{Variable::Kind::state, i}, before, state_change_});
  points_.set_state_delta(graph_, i, now);
}

void Engine::set_landmark(int j, const double* delta, int slot) {
  const Vector3 now = Eigen::Map<const Vector3>(delta);
  const Vector3 before = points_.landmark_delta(j);
  const double size = size_of_landmark(j, now - before);
  slot_change_[index(slot)] = size;
  Vector12 kept = Vector12::Zero();
  kept.head<3>() = before;
  changes_.push_back({{Variable::Kind::landmark, j}, kept, size});
  points_.set_landmark_delta(graph_, j, now);
}

/// What landmarks that came back have taught about older stages may change by this before these are solved anew
/// [standard deviations of their noise]: as much as `solve_tolerance` is worth, in cost.
constexpr double kNoiseTolerance = 0.3;

/// Changes that may wait [tolerances of what is skipped for good].
constexpr double kSmall = 30.0;

/// Solves back from the root through the stages. All stages that were redone are solved; older ones as long as the
/// change of the separator, added up over the updates since the stage was last solved, is above the tolerance: so what
/// is skipped stays bounded however long it goes on. Beyond depth_ changes wait for an update that reaches farther back
/// as long as they are small: every landmark that comes back changes all of history, a little. Where the separator has
/// changed since is not known then, so all stages are solved.
void Engine::solve_back(UpdateSummary& summary) {
  const Root& root = factorisation_.root();
  const int newest = factorisation_.done();
  slot_change_.assign(index(Root::slot_of_row(root.stride()) + 1), 0.0);
  set_state(newest, delta_.data() + Root::row_of_state(newest));
  int landmarks = 0;
  for (int slot = 0; slot < root.slots(); ++slot) {
    if (root.occupant(slot) < 0) continue;
    set_landmark(root.occupant(slot), delta_.data() + Root::row_of_slot(slot), slot);
    ++landmarks;
  }
  clear_returns(newest + 1);
  const double tolerance = options_.solve_tolerance / std::sqrt(std::max(1, landmarks));
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
        const int j = conditional.landmarks[i], row = conditional.rows[i], slot = Root::slot_of_row(row);
        if (factorisation_.eliminated_at(j) == k) {
          set_landmark(j, delta_.data() + row, slot);
        } else {
          Vector3& before = factorisation_.returns().find(j, k)->delta_before;  // it came back later
          const Vector3 now = Eigen::Map<const Vector3>(delta_.data() + row);
          slot_change_[index(slot)] = size_of_landmark(j, now - std::exchange(before, now));
        }
      }
      if (conditional.state >= 0) set_state(conditional.state, delta_.data() + conditional.rows.back());
    }
    for (const int slot : stage.entered_slots) slot_change_[index(slot)] = 0.0;
    for (auto move = stage.moved.rbegin(); move != stage.moved.rend(); ++move) {
      slot_change_[index(move->from)] = std::exchange(slot_change_[index(move->to)], 0.0);
    }
    clear_returns(k);
  }
  waiting_ = 0.0;
}

/// Landmarks that came back before stage k are in no slot before it.
void Engine::clear_returns(int k) {
  const Returns& returns = factorisation_.returns();
  for (int i = returns.first_after(k - 1); i < returns.size() && returns[i].before == k; ++i) {
    slot_change_[index(returns[i].slot)] = 0.0;
  }
}

/// The largest change among what stage k is solved from: state k and the landmarks alive after it.
double Engine::separator_change(int k) const {
  const int slots = Root::slot_of_row(factorisation_.stage(k).conditionals.back().extent);
  double change = state_change_;
  for (int slot = 0; slot < slots; ++slot) change = std::max(change, slot_change_[index(slot)]);
  return change;
}

/// Landmarks that have moved a lot are solved for by themselves, given the poses as they are now: back towards where
/// they were as far as their own cost asks for it, then by Gauss-Newton steps of 3 unknowns. A landmark seen with
/// little parallax easily overshoots, through the camera even, and this costs no new factorisation as damping would.
/// The result becomes its linearisation point with the next update.
void Engine::refine_landmarks() {
  for (Change& change : changes_) {
    const int j = change.variable.index;
    if (change.variable.kind != Variable::Kind::landmark || !(change.size > options_.check_step)) continue;
    if (factorisation_.in_base(change.variable)) continue;  // its own cost isn't known any more
    const Vector3 before = change.before.head<3>();
    const Vector3 start = points_.landmark(j) + before;
    const Vector3 step = points_.landmark_delta(j) - before;
    const Vector3 refined = refine_landmark(LandmarkViews(graph_, j), start, step, change.size);
    points_.set_landmark_delta(graph_, j, refined - points_.landmark(j));
    refined_.push_back(change.variable);
  }
}

/// Whether the last solve raised the cost of the intervals around states that changed a lot (elsewhere the linear model
/// is trusted, which is what the thresholds of relinearisation are for).
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

/// Of some intervals, and the priors of landmarks that changed.
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

/// Exchanges the increments with those of before the last solve, of which each variable was part once.
void Engine::swap_changes() {
  factorisation_.swap_known();
  for (Change& change : changes_) {
    const int i = change.variable.index;
    if (change.variable.kind == Variable::Kind::state) {
      const Vector12 now = points_.state_delta(i);
      points_.set_state_delta(graph_, i, change.before);
      change.before = now;
    } else {
      const Vector3 now = points_.landmark_delta(i);
      points_.set_landmark_delta(graph_, i, change.before.head<3>());
      change.before.head<3>() = now;
    }
  }
}

/// Half of the last solve's step, in the same direction.
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

}  // namespace evbench::gp_map
