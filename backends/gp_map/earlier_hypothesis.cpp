#include "backends/gp_map/earlier_hypothesis.hpp"

#include <algorithm>
#include <utility>

#include "backends/gp_map/factors.hpp"
#include "backends/gp_map/recent_hypothesis.hpp"

namespace evbench::gp_map {
namespace {

constexpr double kBetween = 0.6;      ///< [s] between attempts
constexpr double kStep = 0.3;         ///< [s] between the ends of parts, once one has a better alternative
constexpr double kQuiet = 0.7;        ///< [s] without a better alternative, after which both estimates agree
constexpr double kPatience = 1.5;     ///< [s] the same once a full solution was not better
constexpr double kWorthwhile = 50.0;  ///< sum of the advantages from which everything is solved
constexpr int kAttempts = 3;          ///< full solutions from one passage
constexpr int kWork = 10'000'000;     ///< linearised observations that all full solutions together may take
constexpr int kEarlierIterations = 25;
constexpr double kEarlierTolerance = 1e-4;
constexpr double kClearly = 1e-3;  ///< share by which the cost must be lower: ten times the tolerance

/// The problem with time running backwards; landmarks keep their indices. It has no pose priors, because only parts of
/// it are solved.
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
        back.add_observation(group.landmark, {-z.t, z.pixel, z.whitening});
      }
    }
  }
  return back;
}

/// The problem with the estimate of the backward one, with its own oldest pose and scale.
FactorGraph forwards(const FactorGraph& back, FactorGraph graph) {
  const SE3 G = graph.states.front().T * back.states.back().T.inverse();
  auto state = graph.states.rbegin();
  for (const ControlState& other : back.states) *state++ = {-other.t, G * other.T, -other.velocity};
  for (std::size_t j = 0; j < graph.landmarks.size(); ++j) graph.landmarks[j].position = G * back.landmarks[j].position;
  to_anchored_scale(graph);
  return graph;
}

/// The better alternative estimate of the newest part until time t, of both plane hypotheses.
std::optional<RecentHypothesis> try_alternatives(const FactorGraph& graph, double t, int enough) {
  std::optional<RecentHypothesis> best;
  const int last = graph.first_state_after(t);
  if (last == std::ssize(graph.states)) return best;
  for (const StructureHypothesis hypothesis : {StructureHypothesis::frontal_plane, StructureHypothesis::dual_plane}) {
    auto search = HypothesisSearch::begin(graph, {0, last}, enough, hypothesis);
    if (!search) continue;
    while (search->run_share()) {
    }
    const auto& found = search->found();
    if (found && (!best || found->advantage > best->advantage)) best = found;
  }
  return best;
}

/// A passage backwards through the problem, from a part with a better alternative estimate on.
struct Passage {
  Engine back;
  double until;            ///< [s] end of the last such part, in backward time
  double advantage = 0.0;  ///< sum over all parts

  void take(const RecentHypothesis& other, double t) {
    other.place_in(back);
    until = t;
    advantage += other.advantage;
  }

  /// Continues until no part has a better alternative.
  void extend(int enough, double quiet) {
    for (double t = until + kStep; t < until + quiet; t += kStep) {
      if (const auto other = try_alternatives(back.graph(), t, enough)) take(*other, t);
    }
  }
};

}  // namespace

std::optional<Engine> try_earlier_hypotheses(const Engine& engine, int enough) {
  int solutions = kWork / kEarlierIterations / std::max(1, engine.graph().observation_count());
  if (solutions < 2) return std::nullopt;  // one of the present estimate and one of an alternative
  std::optional<Engine> best;
  std::optional<double> cost;  // the lowest so far, at first that of the present estimate
  FactorGraph back = backwards(engine.graph());
  const double end = back.states.back().t;
  for (double t = back.states.front().t + kBetween; t < end && solutions > 0; t += kBetween) {
    const auto other = try_alternatives(back, t, enough);
    if (!other) continue;
    Passage passage{Engine(back, {}), t};
    passage.take(*other, t);
    passage.extend(enough, kQuiet);
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
      passage.extend(enough, kPatience);
    }
    if (!lower) t = until;  // otherwise the same parts are tried again
  }
  return best;
}

}  // namespace evbench::gp_map
