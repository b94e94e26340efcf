#pragma once

#include <optional>

#include "backends/gp_map/smoother.hpp"
#include "core/plugin/options.hpp"
#include "core/smoother/factor_graph.hpp"

namespace evbench::gp_map {

/// Whether the final estimate is to be trusted.
struct ValidationOptions {
  bool enabled = true;
  double disagreement = 0.01;
  int iterations = 30;

  void declare(OptionSet& set);
};

/// Estimates the trajectory twice, with every second landmark each, from the present estimate on. Returns the root mean
/// square distance of both from the whole estimate, after alignment by similarities, as a share of the path or, if the
/// path is very short, of the scene's distance. Halves scatter around the whole as far as the whole scatters around the
/// truth; a bias that grows with noise draws them away from it as far as it has drawn the whole from the truth (the
/// jackknife, Quenouille 1956). Infinite if a half has no finite estimate; none if there are too few landmarks. `graph`
/// has the full history.
std::optional<double> difference_of_halves(const FactorGraph& graph, const ValidationOptions& options);

}  // namespace evbench::gp_map
