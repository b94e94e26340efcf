#pragma once

#include "backends/gp_map/factor_graph.hpp"
#include "core/data/problem.hpp"

namespace evbench::gp_map {

/// The solver's form of a problem, after prepare(): landmark and state indices stay; landmarks without usable
/// observations have none and are not alive.
FactorGraph to_graph(const Problem& problem);

/// The problem file's form of what a run ended with: present estimates as initial guess. Landmarks that were removed
/// are left out, the others numbered anew. Scale anchor and robust loss have no record in the format and are dropped.
Problem to_problem(const FactorGraph& graph);

}  // namespace evbench::gp_map
