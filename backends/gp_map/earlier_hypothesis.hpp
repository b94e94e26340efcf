#pragma once

#include <optional>

#include "backends/gp_map/engine/engine.hpp"

namespace evbench::gp_map {

/// With everything seen, what was explained wrongly when only the past was known can be explained from what came after
/// it. So the problem is looked through with time running backwards, part by part (recent_hypothesis.hpp). From a part
/// that is explained better otherwise on, all is gone through as long as parts are: what is in view there holds the
/// next part, the scale included. Then everything is solved from there, and where that does not suffice, what lies
/// before is gone through once more.
///
/// A solver of this full history whose cost is clearly lower than the one that the present estimate leads to; none
/// where there is no such explanation. `enough` as for HypothesisSearch. A look takes as long as some dozens of
/// updates, and there are two every 0.6 s of data; everything is solved as often as a bound on that work allows, which
/// is never from 200,000 observations on: then nothing is looked for.
std::optional<Engine> try_earlier_hypotheses(const Engine& engine, int enough);

}  // namespace evbench::gp_map
