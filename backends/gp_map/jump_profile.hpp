#pragma once

#include <set>
#include <vector>

#include "backends/gp_map/factor_graph.hpp"

namespace evbench::gp_map {

/// Time profile of a pose jump, a motion of the camera that the estimate has missed: for each state from a first one
/// on, the share of the motion until then. It is complete at the newest state but one.
using JumpProfile = std::vector<double>;

/// Candidate profiles of a pose jump: sudden, in one of the few intervals with the fewest landmarks seen before and
/// after, some time apart; or spread over time, mostly over such intervals. Landmarks in `left_out` are ignored.
std::vector<JumpProfile> jump_profiles(const FactorGraph& graph, int first, const std::set<int>& left_out);

}  // namespace evbench::gp_map
