#pragma once

#include "core/smoother/factor_graph.hpp"

namespace evbench::smoother {

/// The problem's cost, ½ Σ ρ(‖whitened residual‖²), by parts.
struct Cost {
  double measurements = 0.0, motion_prior = 0.0, priors = 0.0;
  double total() const { return measurements + motion_prior + priors; }
};
Cost evaluate(const FactorGraph& graph);

}  // namespace evbench::smoother
