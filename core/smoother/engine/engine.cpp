#include "core/smoother/engine/engine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace evbench::smoother {
namespace {

constexpr int kAll = std::numeric_limits<int>::max();

}  // namespace

Engine::Engine(FactorGraph graph, const SmootherOptions& options)
    : graph_(std::move(graph)),
      options_(options),
      points_(options.kept_intervals, graph_.state_size()),
      factorisation_(options.grace, graph_.state_size()) {
  for (const ControlState& state : graph_.states) points_.add_state(state);
  for (const auto& landmark : graph_.landmarks) {
    points_.add_landmark(landmark.position);
    factorisation_.add_landmark();
  }
  for (int k = 1; k < static_cast<int>(graph_.states.size()); ++k) points_.errors().take(graph_, k);
}

void Engine::add_state(const ControlState& guess) {
  graph_.add_state(guess);
  points_.add_state(guess);
  mark_dirty(static_cast<int>(graph_.states.size()) - 1);
}

void Engine::add_state_at(double t) {
  const ControlState newest = graph_.states.empty() ? ControlState{t, SE3(), Vector6::Zero()} : graph_.states.back();
  add_state(extrapolate(newest, t - newest.t, graph_.motion_prior));
}

void Engine::add_pose_prior(const PosePrior& prior) {
  graph_.pose_priors.push_back(prior);
  mark_dirty(prior.state);
}

void Engine::add_velocity_prior(const VelocityPrior& prior) {
  graph_.velocity_priors.push_back(prior);
  mark_dirty(prior.state);
}

void Engine::anchor_scale(const Vector3& origin, std::vector<int> landmarks) {
  mark_landmarks_dirty(graph_.anchor.landmarks);
  graph_.anchor_scale(origin, std::move(landmarks));
  factorisation_.renew_anchor();
  mark_landmarks_dirty(graph_.anchor.landmarks);
}

int Engine::add_landmark(const Vector3& guess, const LandmarkPrior& prior) {
  points_.add_landmark(guess);
  factorisation_.add_landmark();
  return graph_.add_landmark(guess, prior);
}

bool Engine::add_observation(int landmark, const Observation& observation) {
  live_.drop();
  return insert(landmark, observation);
}

bool Engine::insert(int landmark, const Observation& observation) {
  const bool sound = std::isfinite(observation.t) && observation.pixel.allFinite() &&
                     observation.whitening.is_valid() && graph_.landmarks[index(landmark)].alive;
  if (!sound || factorisation_.is_marginalised(landmark)) return false;
  const int k = graph_.interval_of(observation.t);
  if (k <= factorisation_.base() || !graph_.add_observation(landmark, observation)) return false;
  points_.invalidate(k);
  invalidate(k);
  if (const auto eliminated = factorisation_.eliminated_at(landmark)) {
    const bool far = k > *eliminated + options_.redone_for_return ||
                     (k > *eliminated && factorisation_.oldest_redone(*eliminated, graph_) < *eliminated);
    if (far && options_.lag == 0.0) {
      factorisation_.bring_back(landmark);
    } else {
      invalidate(*eliminated);
    }
  }
  return true;
}

void Engine::remove_newest_state() {
  const int newest = static_cast<int>(graph_.states.size()) - 1;
  live_.drop();
  graph_.remove_newest_state();
  points_.remove_newest_state();
  std::erase(candidates_, Variable{Variable::Kind::state, newest});
  mark_dirty(newest);
}

void Engine::set_qc(int k, const Vector6& qc, double expansion) {
  if (k <= factorisation_.base()) return;
  graph_.qcs[index(k)] = qc;
  graph_.expansions[index(k)] = expansion;
  points_.invalidate(k);
  mark_dirty(k);
}

void Engine::remove_prior(int landmark) {
  FactorGraph::Landmark& known = graph_.landmarks[index(landmark)];
  if (known.intervals.empty() || factorisation_.is_marginalised(landmark)) return;
  if (factorisation_.in_base({Variable::Kind::landmark, landmark})) return;
  known.prior = {};
  mark_landmarks_dirty({&landmark, 1});
}

void Engine::remove_landmark(int landmark) {
  mark_observations_dirty(landmark);
  const std::vector<int>& anchors = graph_.anchor.landmarks;
  if (std::ranges::find(anchors, landmark) != anchors.end()) mark_landmarks_dirty(anchors);
  graph_.remove_landmark(landmark);
}

void Engine::remove_observations(int landmark, double from) {
  const std::vector<int>& seen = graph_.landmarks[index(landmark)].intervals;
  if (seen.empty() || graph_.states[index(seen.back())].t < from) return;
  for (const int k : seen) {
    if (graph_.states[index(k)].t < from) continue;
    points_.invalidate(k);
    mark_dirty(k);
  }
  graph_.remove_observations(landmark, from);
}

void Engine::scale_sigmas(int landmark, double scale) {
  mark_observations_dirty(landmark);
  graph_.scale_sigmas(landmark, scale);
}

bool Engine::set_state(int i, const ControlState& estimate) {
  if (i <= factorisation_.base()) return false;
  const Variable variable{Variable::Kind::state, i};
  const ControlState& point = points_.state(i);
  StateVector delta(graph_.state_size());
  delta.head<12>() << se3::log(point.T.inverse() * estimate.T), estimate.velocity - point.velocity;
  if (graph_.motion_prior.has_acceleration()) delta.tail<6>() = estimate.acceleration - point.acceleration;
  points_.set_state_delta(graph_, i, delta);
  move(variable);
  return true;
}

bool Engine::set_landmark(int landmark, const Vector3& position) {
  const Variable variable{Variable::Kind::landmark, landmark};
  if (factorisation_.in_base(variable) || factorisation_.is_marginalised(landmark)) return false;
  if (factorisation_.returns().last_of(landmark) != nullptr) return false;
  points_.set_landmark_delta(graph_, landmark, position - points_.landmark(landmark));
  move(variable);
  return true;
}

/// Marks everything dirty that depends on a landmark's observations.
void Engine::mark_observations_dirty(int landmark) {
  mark_landmarks_dirty({&landmark, 1});
  for (const int k : graph_.landmarks[index(landmark)].intervals) points_.invalidate(k);
}

/// Marks the stages dirty in which these landmarks enter.
void Engine::mark_landmarks_dirty(std::span<const int> landmarks) {
  for (const int j : landmarks) {
    if (!graph_.landmarks[index(j)].intervals.empty()) mark_dirty(graph_.landmarks[index(j)].intervals.front());
  }
}

double Engine::reprojection_mean(int landmark) {
  if (!newest_errors_taken_ && graph_.states.size() > 1) {
    points_.errors().take(graph_, static_cast<int>(graph_.states.size()) - 1);
  }
  newest_errors_taken_ = true;
  return points_.errors().mean(landmark);
}

double Engine::size_of_state(int i, const StateVector& delta) const {
  if (!delta.allFinite()) return std::numeric_limits<double>::infinity();
  const double dt = i > 0 ? graph_.states[index(i)].t - graph_.states[index(i - 1)].t : 0.0;
  // Of s (1 − s)², and of the corresponding weight of the quintic polynomial.
  const double kHermiteMaximum = graph_.motion_prior.has_acceleration() ? 0.2 : 4.0 / 27.0;
  const double rotation = delta.head<3>().norm() + kHermiteMaximum * dt * delta.segment<3>(6).norm();
  const double translation = delta.segment<3>(3).norm() + kHermiteMaximum * dt * delta.segment<3>(9).norm();
  double turn = 0.0, way = 0.0;
  if (graph_.motion_prior.has_acceleration()) {
    constexpr double kQuinticMaximum = 0.018;  // of s² (1 − s)³/2
    turn = kQuinticMaximum * dt * dt * delta.segment<3>(12).norm();
    way = kQuinticMaximum * dt * dt * delta.tail<3>().norm();
  }
  return std::max(rotation + turn, (translation + way) / points_.nearest(i));
}

/// √(|δ|/d · |δ⊥|/d), the larger value of the first and the last camera that see the landmark. The error of a
/// linearised projection is of second order: a change of distance times a change of direction. The direction counts as
/// at least 1 % of the change, because poses are not known better than such a parallax.
double Engine::size_of_landmark(int j, const Vector3& delta) const {
  const auto& seen = graph_.landmarks[index(j)].intervals;
  if (seen.empty()) return 0.0;
  if (!delta.allFinite()) return std::numeric_limits<double>::infinity();
  constexpr double kParallax = 0.01, kNearest = 1e-9;
  const double square = delta.squaredNorm();
  double largest = 0.0;  // fourth power of the size
  for (const int k : {seen.front(), seen.back()}) {
    const Vector3 ray = points_.landmark(j) - points_.state(k).T.p;
    const double distance2 = std::max(ray.squaredNorm(), kNearest * kNearest);
    const double along = square / distance2;
    const double across = ray.cross(delta).squaredNorm() / (distance2 * distance2);
    largest = std::max(largest, along * std::max(across, kParallax * kParallax * along));
  }
  return std::sqrt(std::sqrt(largest));
}

int Engine::first_stage(const Variable& variable) {
  if (factorisation_.in_base(variable)) return factorisation_.base() + 1;
  if (variable.kind == Variable::Kind::state) return variable.index;
  const Return* came_back = factorisation_.returns().last_of(variable.index);
  if (came_back != nullptr && came_back->from <= factorisation_.snapshot_before(restart_)) return came_back->before;
  const auto& seen = graph_.landmarks[index(variable.index)].intervals;
  return seen.empty() ? restart_ : seen.front();
}

void Engine::move(const Variable& variable) {
  mark_dirty(first_stage(variable));
  if (variable.kind == Variable::Kind::state) {
    const StateVector delta = points_.state_delta(variable.index);
    points_.move_state(graph_, variable.index);
    factorisation_.shift_base(variable, delta.data());
  } else {
    const Vector3 delta = points_.landmark_delta(variable.index);
    if (Return* came_back = factorisation_.returns().last_of(variable.index)) came_back->offset += delta;
    points_.move_landmark(graph_, variable.index);
    factorisation_.shift_base(variable, delta.data());
  }
}

/// Marginalises the states older than the lag.
void Engine::marginalise_old() {
  const double from = graph_.states.back().t - options_.lag;
  const int last = static_cast<int>(graph_.states.size()) - 2;  // the newest interval is always estimated
  int oldest = factorisation_.base() + 1;
  if (oldest > last) return;
  while (oldest < last && graph_.states[index(oldest)].t < from) ++oldest;
  const int before = factorisation_.base();
  const int base = factorisation_.marginalise(oldest);
  for (int k = before + 1; k <= base; ++k) {
    graph_.drop_observations(k);
    points_.errors().settle(k);
  }
  std::erase_if(candidates_, [&](const Variable& v) {
    return v.kind == Variable::Kind::state ? v.index < base : factorisation_.is_marginalised(v.index);
  });
}

/// Moves the linearisation points that are too far from the estimate. In stages that are redone anyway a lower
/// threshold applies.
void Engine::choose_points() {
  const auto size = [&](const Variable& v) {
    return v.kind == Variable::Kind::state ? size_of_state(v.index, points_.state_delta(v.index))
                                           : size_of_landmark(v.index, points_.landmark_delta(v.index));
  };
  const int oldest = static_cast<int>(graph_.states.size()) - options_.reach;
  for (const Variable& variable : candidates_) {
    const int first = first_stage(variable);
    if (first >= restart_ || (first >= oldest && factorisation_.oldest_redone(first, graph_) >= oldest)) {
      move(variable);
    }
  }
  candidates_.clear();
  const auto move_if_far = [&](const Variable& variable) {
    if (size(variable) > options_.relinearise_redone) move(variable);
  };
  // None of these moves affects an older stage: a state enters with its own stage, a landmark with its first stage or
  // where it returned.
  Returns& returns = factorisation_.returns();
  for (int i = returns.first_after(restart_ - 1); i < returns.size(); ++i) {
    const Variable landmark{Variable::Kind::landmark, returns[i].landmark};
    if (first_stage(landmark) == returns[i].before) move_if_far(landmark);
  }
  const int newest = static_cast<int>(graph_.states.size()) - 1;  // done stages may include that of a removed state
  for (int k = std::max(restart_, 0); k <= std::min(factorisation_.done(), newest); ++k) {
    move_if_far({Variable::Kind::state, k});
    for (const int j : factorisation_.stage(k).entered) move_if_far({Variable::Kind::landmark, j});
  }
}

UpdateSummary Engine::update() {
  constexpr int kEach = 64, kMost = 1 << 20;
  ++updates_;
  return update_back(options_.lag > 0.0 ? kAll : kEach * std::min(updates_ & -updates_, kMost));
}

UpdateSummary Engine::update_everything() { return update_back(kAll); }

/// One update that solves back at most `depth` stages that were not redone.
UpdateSummary Engine::update_back(int depth) {
  depth_ = depth;
  UpdateSummary summary;
  if (graph_.states.empty()) {
    restart_ = 0;
    return summary;
  }
  live_.drop();
  newest_errors_taken_ = false;
  const std::int64_t stages = factorisation_.stages_done();
  const std::int64_t linearised = points_.linearised_observations();
  choose_points();
  const int first = summary.first_stage = restart_;
  constexpr double kFirstDamping = 1e-3, kDampingGrowth = 30.0, kMaxDamping = 1e3;
  double damping = 0.0;
  while (true) {
    const bool solved = solve(damping, summary);
    if (solved) {
      refine_landmarks();
      if (!raises_cost()) break;
    }
    if (solved) swap_changes();
    damping = damping == 0.0 ? kFirstDamping : kDampingGrowth * damping;
    if (damping > kMaxDamping || (!solved && !summary.reason.empty() && damping > 1.0)) {
      summary.rejected = true;
      summary.unsolvable = !solved;
      break;
    }
    restart_ = first;
  }
  summary.damping = damping;
  // Damped stages are not those of the actual problem: the next update redoes them.
  restart_ = damping == 0.0 ? static_cast<int>(graph_.states.size()) : first;
  for (const Change& change : changes_) {
    const Variable& v = change.variable;
    const double size = v.kind == Variable::Kind::state ? size_of_state(v.index, points_.state_delta(v.index))
                                                        : size_of_landmark(v.index, points_.landmark_delta(v.index));
    if (size > options_.relinearise) candidates_.push_back(v);
  }
  candidates_.insert(candidates_.end(), refined_.begin(), refined_.end());
  if (options_.lag > 0.0 && damping == 0.0) marginalise_old();
  summary.stages = static_cast<int>(factorisation_.stages_done() - stages);
  summary.linearised = static_cast<int>(points_.linearised_observations() - linearised);
  return summary;
}

/// Factorises and solves back. Undetermined variables are regularised. False if this does not help.
bool Engine::solve(double damping, UpdateSummary& summary) {
  changes_.clear();
  refined_.clear();
  damped_ = damping > 0.0;
  int attempts = static_cast<int>(graph_.landmarks.size() + graph_.states.size());
  while (attempts-- > 0) {
    std::optional<Variable> singular = factorisation_.redo(restart_, graph_, points_, damping);
    if (!singular) {
      restart_ = static_cast<int>(graph_.states.size());
      singular = factorisation_.factorise_root(points_, damping);
      if (singular) restart_ = factorisation_.done();
    }
    if (!singular) {
      factorisation_.solve_root(delta_);
      solve_back(summary);
      return true;
    }
    if (factorisation_.is_regularised(*singular)) {
      summary.reason = "the normal equations are singular or indefinite at " + singular->name();
      return false;
    }
    summary.reason = singular->name() + " is not determined by its observations and priors";
    factorisation_.regularise(*singular);
    restart_ = factorisation_.done() + 1;
  }
  return false;
}

OptimiseSummary Engine::optimise(int max_iterations, double relative_tolerance) {
  OptimiseSummary summary;
  summary.initial_cost = summary.final_cost = evaluate(graph_).total();
  constexpr double kDampingOfSteps = 1e-3;  ///< below it a small decrease means a minimum, not a short step
  constexpr double kMaxDamping = 1e8, kRounding = 1e-11;
  // The smallest share of a step that is tried, by halving, before damping takes over. Damping slows the slow modes
  // most; a shorter step keeps its direction.
  constexpr double kLeastShare = 1.0 / 16.0;
  double damping = 0.0;
  while (summary.iterations < max_iterations && !summary.converged) {
    for (int i = 0; i < static_cast<int>(graph_.states.size()); ++i) points_.move_state(graph_, i);
    for (int j = 0; j < static_cast<int>(graph_.landmarks.size()); ++j) points_.move_landmark(graph_, j);
    ++summary.iterations;
    const double first_damping = damping;
    bool accepted = false;
    while (!accepted && !summary.converged && damping < kMaxDamping) {
      restart_ = 0;
      UpdateSummary update;
      const bool solved = solve(damping, update);
      summary.reason = update.reason;
      double cost = solved ? evaluate(graph_).total() : 0.0;
      double share = 1.0;
      for (; solved && !(cost <= summary.final_cost) && share > kLeastShare; share *= 0.5) {
        halve_changes();
        cost = evaluate(graph_).total();
      }
      const double decrease = summary.final_cost - cost;
      accepted = solved && decrease >= 0.0;
      const bool little = std::abs(decrease) <= std::max(kRounding, relative_tolerance) * summary.final_cost;
      summary.converged = solved && little && damping < kDampingOfSteps && share == 1.0;
      if (accepted) {
        summary.final_cost = cost;
        damping = damping < 1e-6 ? 0.0 : 0.1 * damping;
      } else {
        if (solved) swap_changes();
        damping = damping == 0.0 ? 1e-6 : 10.0 * damping;
      }
    }
    if (accepted || summary.converged) continue;
    if (first_damping == 0.0) break;  // no damping helps
    damping = 0.0;
  }
  restart_ = damping == 0.0 ? static_cast<int>(graph_.states.size()) : 0;
  candidates_.clear();
  return summary;
}

}  // namespace evbench::smoother
