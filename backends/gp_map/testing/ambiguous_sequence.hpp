#pragma once

#include <cstdint>

#include "backends/gp_map/smoother.hpp"
#include "core/smoother/factor_graph.hpp"

/// Simulated sequences in front of a plane that have an alternative estimate.
namespace evbench::gp_map::ambiguous_sequence {

constexpr int kStates = 40, kOld = 15, kLandmarks = 90, kEnough = 6;
constexpr double kStep = 0.05, kSigma = 0.3;

/// Rotation [rad/s] and forward motion [m/s] of a camera that moves sideways.
struct CameraMotion {
  double turn = 0.0, ahead = 0.0;
};

/// A problem at its true values: a camera in front of a plane, and landmarks that are seen for 0.5 s (old ones, with a
/// prior) or 0.8 s. The problem of a tentative map has no priors on landmarks; its scale is that of the first ones.
/// After 2 s the camera turns and moves back.
FactorGraph simulate_problem(const CameraMotion& motion, std::uint64_t seed, bool tentative = false,
                             int states = kStates);

/// Solved from an estimate with the new landmarks on a plane normal to the motion.
FactorGraph misled(FactorGraph graph);

FactorGraph solved(FactorGraph graph);

double cost(const FactorGraph& graph);

}  // namespace evbench::gp_map::ambiguous_sequence
