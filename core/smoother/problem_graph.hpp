#pragma once

#include "core/data/problem.hpp"
#include "core/smoother/factor_graph.hpp"

namespace evbench::smoother {

/// The solver's form of a problem, after prepare(): landmark and state indices stay; landmarks without usable
/// observations have none and are not alive.
FactorGraph to_graph(const Problem& problem, const MotionPrior& motion_prior = {});

/// The problem file's form of the result of a run: present estimates become the initial guess. Removed landmarks are
/// left out, and the others are renumbered. The format has no robust loss and no scale anchor: the loss is dropped, and
/// each of the anchor's landmarks gets a prior at its present estimate, with a sigma of 5 % of its distance. Densities
/// of the prior become their geometric mean; its kind and accelerations are dropped. Sigmas are increased according to
/// the share of information that the loss counts.
Problem to_problem(const FactorGraph& graph);

}  // namespace evbench::smoother
