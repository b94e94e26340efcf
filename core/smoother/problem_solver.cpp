#include "core/smoother/problem_solver.hpp"

#include <algorithm>
#include <chrono>

#include "core/smoother/problem_graph.hpp"
#include "core/support/index.hpp"
#include "core/support/peak_memory.hpp"
#include "core/support/seconds_since.hpp"

namespace evbench::smoother {
namespace {

/// Feeds a prepared problem to the engine, a control state at a time.
class IncrementalRun {
 public:
  IncrementalRun(const Problem& problem, const SolveOptions& options)
      : problem_(problem),
        engine_(problem.camera, problem.qc, RobustLoss(), engine_options(options), options.motion_prior),
        number_(problem.landmarks.size(), -1),
        held_back_(problem.landmarks.size(), -1),
        priors_(problem.landmarks.size()) {
    for (const auto& prior : problem.landmark_priors) {
      priors_[index(prior.landmark)] = {prior.position, prior.sigma};
    }
  }

  SolveResult run() {
    SolveResult result;
    for (std::size_t k = 0; k < problem_.states.size(); ++k) {
      const auto start = std::chrono::steady_clock::now();
      add_step(k);
      result.updates.push_back(engine_.update());
      result.step_ms.push_back(1e3 * seconds_since(start));
      result.total_s += 1e-3 * result.step_ms.back();
      if (!result.updates.back().reason.empty()) result.reason = result.updates.back().reason;
    }
    const auto start = std::chrono::steady_clock::now();
    engine_.update_everything();
    result.total_s += seconds_since(start);
    result.peak_mib = peak_memory_mib();
    result.graph = complete_graph();
    return result;
  }

 private:
  static SmootherOptions engine_options(const SolveOptions& options) {
    SmootherOptions engine = options.engine;
    if (options.mode == SolveMode::fixed_lag) engine.lag = options.lag;
    return engine;
  }

  /// All factors with the final estimate: with a lag the engine has dropped most of them.
  FactorGraph complete_graph() const {
    FactorGraph graph = to_graph(problem_, engine_.graph().motion_prior);
    graph.states = engine_.graph().states;
    for (std::size_t j = 0; j < number_.size(); ++j) {
      if (number_[j] < 0) continue;
      graph.landmarks[j].position = engine_.graph().landmarks[index(number_[j])].position;
    }
    return graph;
  }

  void add_step(std::size_t k) {
    const ControlState& state = problem_.states[k];
    if (k == 0) {
      engine_.add_state(state);
    } else {
      const ControlState& newest = engine_.graph().states.back();
      ControlState next = extrapolate(newest, state.t - newest.t, engine_.graph().motion_prior);
      next.t = state.t;  // to the last bit: observations may be at this time
      engine_.add_state(next);
    }
    for (const auto& prior : problem_.pose_priors) {
      if (prior.state == static_cast<int>(k)) engine_.add_pose_prior({prior.state, prior.T, prior.sigma});
    }
    for (const auto& prior : problem_.velocity_priors) {
      if (prior.state == static_cast<int>(k)) engine_.add_velocity_prior({prior.state, prior.velocity, prior.sigma});
    }
    if (k == 0) return;
    const auto& all = problem_.observations;
    for (; next_ < all.size() && all[next_].t <= state.t; ++next_) add(next_);
  }

  void add(std::size_t i) {
    const Problem::Observation& z = problem_.observations[i];
    const auto landmark = static_cast<std::size_t>(z.landmark);
    if (number_[landmark] < 0) {
      if (held_back_[landmark] < 0) {
        held_back_[landmark] = static_cast<std::int64_t>(i);
        return;
      }
      number_[landmark] = engine_.add_landmark(problem_.landmarks[landmark], priors_[landmark]);
      observe(problem_.observations[index(held_back_[landmark])]);
    }
    observe(z);
  }

  void observe(const Problem::Observation& z) {
    engine_.add_observation(number_[index(z.landmark)], {z.t, z.pixel, z.noise.whitening()});
  }

  const Problem& problem_;
  Smoother engine_;
  std::vector<int> number_;              ///< of a problem's landmark in the engine, −1: not in yet
  std::vector<std::int64_t> held_back_;  ///< the only observation of a landmark so far
  std::vector<LandmarkPrior> priors_;
  std::size_t next_ = 0;
};

SolveResult solve_at_once(const Problem& problem, const SolveOptions& options) {
  SolveResult result;
  Smoother engine(to_graph(problem, options.motion_prior), options.engine);
  const auto start = std::chrono::steady_clock::now();
  const auto summary = engine.optimise(options.max_iterations, 1e-8);
  result.step_ms.push_back(1e3 * seconds_since(start));
  result.total_s = 1e-3 * result.step_ms.back();
  result.reason = summary.reason;
  result.peak_mib = peak_memory_mib();
  result.graph = engine.graph();
  return result;
}

}  // namespace

SolveResult solve_problem(const Problem& problem, const SolveOptions& options) {
  if (options.mode == SolveMode::batch) return solve_at_once(problem, options);
  const Problem usable = prepare(problem);
  return IncrementalRun(usable, options).run();
}

Check check_against_batch(const FactorGraph& estimate) {
  Check check{0.0, estimate};
  const double cost = evaluate(estimate).total();
  solve_batch(check.optimum, {50, 1e-13});
  const double optimum = evaluate(check.optimum).total();
  check.relative_excess = (cost - optimum) / optimum;
  return check;
}

}  // namespace evbench::smoother
