#include "backends/gp_map/earlier_hypothesis.hpp"

#include <algorithm>
#include <utility>

#include "backends/gp_map/factors.hpp"
#include "backends/gp_map/recent_hypothesis.hpp"

namespace evbench::gp_map {
namespace {

constexpr double kLook = 0.6;         ///< [s] between looks
constexpr double kStep = 0.3;         ///< [s] from one part's end to the next one's, once one is explained better
constexpr double kQuiet = 0.7;        ///< [s] without another one: here the explanations meet
constexpr double kPatience = 1.5;     ///< [s] the same once everything has been solved in vain
constexpr double kWorthwhile = 50.0;  ///< advantages together for which everything is solved
constexpr int kAttempts = 3;          ///< to solve it from one passage
constexpr int kWork = 10'000'000;     ///< linearised observations that solving everything may take, all in all
constexpr int kEarlierIterations = 25;
constexpr double kEarlierTolerance = 1e-4;
constexpr double kClearly = 1e-3;  ///< share by which the cost must be lower: ten times what the tolerance leaves open

/// The motion, and how it is observed, with time running backwards; landmarks keep their numbers. Without priors of
/// poses: it is solved by parts alone.
FactorGraph backwards(const FactorGraph& graph) {
  FactorGraph back;
  back.camera = graph.camera;
  back.loss = graph.loss;
  for (const FactorGraph::Landmark& landmark : graph.landmarks) back.add_landmark(landmark.position, landmark.prior);
  const std::size_t n = graph.states.size();
  for (std::size_t k = n; k-- > 0;) {
    const ControlState& state = graph.states[k];
    if (k + 1 < n) back.qc = graph.qcs[k + 1];
    back.add_state({-state.t, state.T, -state.velocity});
    if (k + 1 == n) continue;
    back.expansions.back() = graph.expansions[k + 1];
    for (const auto& group : graph.intervals[k + 1].groups()) {
      for (const Observation& z : graph.intervals[k + 1].of(group)) {
        back.add_observation(group.landmark, {-z.t, z.pixel, z.inverse_sigma});
      }
    }
  }
  return back;
}

/// The problem with the estimate of the one backwards, where the oldest pose and the scale are held.
FactorGraph forwards(const FactorGraph& back, FactorGraph graph) {
  const SE3 G = graph.states.front().T * back.states.back().T.inverse();
  auto state = graph.states.rbegin();
  for (const ControlState& other : back.states) *state++ = {-other.t, G * other.T, -other.velocity};
  for (std::size_t j = 0; j < graph.landmarks.size(); ++j) graph.landmarks[j].position = G * back.landmarks[j].position;
  to_held_scale(graph);
  return graph;
}

/// Of the newest part until time t, by the better beginning.
std::optional<RecentHypothesis> try_alternatives(const FactorGraph& graph, double t, int enough) {
  std::optional<RecentHypothesis> best;
  const int last = graph.first_state_after(t);
  if (last == std::ssize(graph.states)) return best;
  for (const StructureHypothesis supposed : {StructureHypothesis::frontal_plane, StructureHypothesis::dual_plane}) {
    auto search = HypothesisSearch::begin(graph, {0, last}, enough, supposed);
    if (!search) continue;
    while (search->go_on()) {
    }
    const auto& found = search->found();
    if (found && (!best || found->advantage > best->advantage)) best = found;
  }
  return best;
}

/// What is gone through backwards from a part that is explained better otherwise on.
struct Passage {
  Engine back;
  double until;            ///< [s] the last such part's end, backwards
  double advantage = 0.0;  ///< of all parts together

  void take(const RecentHypothesis& other, double t) {
    other.place_in(back);
    until = t;
    advantage += other.advantage;
  }

  /// Until nothing more is explained better.
  void go_on(int enough, double quiet) {
    for (double t = until + kStep; t < until + quiet; t += kStep) {
      if (const auto other = try_alternatives(back.graph(), t, enough)) take(*other, t);
    }
  }
};

}  // namespace

std::optional<Engine> try_earlier_hypotheses(const Engine& engine, int enough) {
  int solutions = kWork / kEarlierIterations / std::max(1, engine.graph().observation_count());
  if (solutions < 2) return std::nullopt;  // of the present explanation and of another one
  std::optional<Engine> best;
  std::optional<double> cost;  // to be undercut, as far down as the present explanation leads
  FactorGraph back = backwards(engine.graph());
  const double end = back.states.back().t;
  for (double t = back.states.front().t + kLook; t < end && solutions > 0; t += kLook) {
    const auto other = try_alternatives(back, t, enough);
    if (!other) continue;
    Passage passage{Engine(back, {}), t};
    passage.take(*other, t);
    passage.go_on(enough, kQuiet);
    if (passage.advantage > kWorthwhile && !cost) {
      cost = Engine(FactorGraph(engine.graph()), {}).optimise(kEarlierIterations, kEarlierTolerance).final_cost;
      --solutions;
    }
    bool lower = false;
    double until = passage.until;
    for (int attempt = 0; attempt < kAttempts && passage.advantage > kWorthwhile; ++attempt) {
      if (solutions-- == 0) return best;
      until = passage.until;
      Engine all(forwards(passage.back.graph(), engine.graph()), {});
      const double reached = all.optimise(kEarlierIterations, kEarlierTolerance).final_cost;
      FactorGraph solved = backwards(all.graph());
      lower = reached < (1.0 - kClearly) * *cost;
      if (lower) {
        cost = reached;
        best = std::move(all);
        back = std::move(solved);
        break;
      }
      if (attempt + 1 == kAttempts) break;
      passage = {Engine(std::move(solved), {}), until};
      passage.go_on(enough, kPatience);
    }
    if (!lower) t = until;  // else what has been gone through is looked at once more
  }
  return best;
}

}  // namespace evbench::gp_map
