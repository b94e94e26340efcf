#include "backends/gp_map/modules/hypothesis_search.hpp"

#include "backends/gp_map/testing/ambiguous_sequence.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {
namespace {

/// Advances a search at most this often; returns what it found.
std::optional<AlternativeEstimate> search(HypothesisSearch& search, Estimate& estimate, int times) {
  for (int i = 0; i < times && !search.is_exhausted(); ++i) {
    if (auto found = search.advance(estimate)) return found;
  }
  return std::nullopt;
}

}  // namespace

TEST_CASE("A search finds the true estimate of a misled map, and is exhausted where there is none", "[slow]") {
  using namespace ambiguous_sequence;
  constexpr int kTimes = 1000;
  for (const bool wrong : {true, false}) {
    FactorGraph graph = simulate_problem({-0.4, 0.0}, 1, true);
    graph = wrong ? misled(std::move(graph)) : solved(std::move(graph));
    Counters counters;
    Estimate estimate(std::move(graph), {}, kEnough, 5.0, counters);
    HypothesisSearch both({.interval = 0.0, .first = 0.0}, 0.0);
    const auto found = search(both, estimate, kTimes);
    CHECK(found.has_value() == wrong);
    CHECK(both.is_exhausted() == !wrong);
    CHECK(counters[Count::alternatives_accepted] == (wrong ? 1 : 0));
    if (!wrong) CHECK(counters[Count::searches] == 2);  // one from each plane
  }
}

TEST_CASE("A search that is switched off, or not due, does nothing") {
  using namespace ambiguous_sequence;
  Counters counters;
  Estimate estimate(simulate_problem({-0.4, 0.0}, 1, true), {}, kEnough, 5.0, counters);
  HypothesisSearch off({.enabled = false}, 0.0), later({.first = 100.0}, 0.0);
  CHECK(off.is_exhausted());
  CHECK_FALSE(off.advance(estimate));
  CHECK_FALSE(later.is_exhausted());
  CHECK_FALSE(later.advance(estimate));
  CHECK_FALSE(later.in_progress());
  CHECK(counters[Count::searches] == 0);
}

}  // namespace evbench::gp_map
