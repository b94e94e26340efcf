#pragma once

#include <cstdint>

#include "backends/gp_map/factor_graph.hpp"

/// Flights before a plane that have another explanation.
namespace evbench::gp_map::ambiguous_sequence {

constexpr int kStates = 40, kOld = 15, kLandmarks = 90, kEnough = 6;
constexpr double kStep = 0.05, kSigma = 0.3;

/// How a camera turns [rad/s] and moves ahead [m/s] while it moves sideways.
struct Way {
  double turn = 0.0, ahead = 0.0;
};

/// Before a plane, past landmarks that live for 0.5 s, if known from before, or 0.8 s: at the true values.
/// A young simulate_problem has no known landmarks: the scale is that of its first ones. After 2 s the camera turns and moves
/// back.
FactorGraph simulate_problem(const Way& way, std::uint64_t seed, bool young = false, int states = kStates);

/// Solved from where what is new, and observed, lies on a plane across the way.
FactorGraph misled(FactorGraph graph);

/// Solved from where near and far have changed places (Necker's reversal).
FactorGraph turned_over(FactorGraph graph);

FactorGraph solved(FactorGraph graph);

double cost(const FactorGraph& graph);

}  // namespace evbench::gp_map::ambiguous_sequence
