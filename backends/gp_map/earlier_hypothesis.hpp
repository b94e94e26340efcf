#pragma once

#include <optional>

#include "backends/gp_map/engine/engine.hpp"

namespace evbench::gp_map {

/// Searches for a better estimate of the past once all data are known. A part that was estimated wrongly from the past
/// alone can be estimated correctly from the data after it. So alternatives are searched with time running backwards,
/// part by part (recent_hypothesis.hpp). From a part with a better alternative on, the passage continues as long as
/// further parts have one: the landmarks in view fix the next part, including its scale. Then everything is solved from
/// there. If that does not suffice, the earlier data are passed once more.
///
/// Returns a solver of this full history whose cost is clearly lower than that of the optimised present estimate; none
/// if there is no such alternative. `enough` as for HypothesisSearch. An attempt takes as long as some dozens of
/// updates, and there are two every 0.6 s of data. The work of full solutions is bounded; from 200,000 observations on
/// the bound allows none, and nothing is searched.
std::optional<Engine> try_earlier_hypotheses(const Engine& engine, int enough);

}  // namespace evbench::gp_map
