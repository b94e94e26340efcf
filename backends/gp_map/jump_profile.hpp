#pragma once

#include <set>
#include <vector>

#include "backends/gp_map/factor_graph.hpp"

namespace evbench::gp_map {

/// How a motion of the camera that nobody noticed came about: for each state from a first one on, its share by then.
/// All of it at the newest state but one.
using JumpProfile = std::vector<double>;

/// How it may have: at once, in one of the few intervals over which the fewest landmarks are seen before and after, as
/// long as they are some time apart; or as time passed, most of it there. Without regard to the landmarks that are left
/// out.
std::vector<JumpProfile> jump_profiles(const FactorGraph& graph, int first, const std::set<int>& left_out);

}  // namespace evbench::gp_map
