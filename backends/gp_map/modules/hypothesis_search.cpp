#include "backends/gp_map/modules/hypothesis_search.hpp"

#include <utility>

namespace evbench::gp_map {

void SearchOptions::declare(OptionSet& set) {
  set.add("enabled", enabled, "alternative estimates with a plane's other structure are searched for");
  set.add("interval", interval, "least time between the beginnings of two searches [s]").range(0.0, 1000.0);
  set.add("first", first, "time of data before the first search [s]").range(0.0);
}

std::optional<AlternativeEstimate> HypothesisSearch::advance(Estimate& estimate) {
  if (!options_.enabled) return std::nullopt;
  if (!search_ && !(estimate.now() < next_)) {
    next_ = estimate.now() + options_.interval;
    const auto hypothesis =
        searches_ % kPlanes == 0 ? StructureHypothesis::frontal_plane : StructureHypothesis::dual_plane;
    search_ = begin(estimate, hypothesis, false);  // first: what is new in view is soon too old to be searched
    if (!search_ && estimate.is_tentative()) search_ = begin(estimate, hypothesis, true);
    if (!search_ && checks_left_ > 0) --checks_left_;  // no alternative is possible
    ++searches_;
    if (search_) estimate.count(Count::searches);
  }
  if (!search_ || search_->run_share()) return std::nullopt;
  auto other = std::exchange(search_, std::nullopt)->found();
  const int oldest = estimate.smoother.first_state();
  if (other && oldest > 0 && other->first <= oldest + 1) other.reset();  // a lag has marginalised it since
  if (checks_left_ > 0) checks_left_ = other ? kPlanes : checks_left_ - 1;
  if (other) estimate.count(Count::alternatives_accepted);
  return other;
}

std::optional<AlternativeSearch> HypothesisSearch::begin(const Estimate& estimate, StructureHypothesis hypothesis,
                                                         bool everything) const {
  const FactorGraph& graph = estimate.graph();
  const StateRange states{estimate.smoother.first_state(), static_cast<int>(graph.states.size()) - 1};
  return AlternativeSearch::begin(graph, states, estimate.enough(), hypothesis, everything);
}

}  // namespace evbench::gp_map
