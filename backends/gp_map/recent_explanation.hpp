#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "backends/gp_map/factor_graph.hpp"

namespace evbench::gp_map {

/// A plane on which all that came into view of late is supposed to lie, as a beginning.
enum class SupposedPlane {
  frontal,  ///< parallel to the image: nothing is supposed about what is near and what is far
  dual,     ///< normal to how the camera seems to have moved: where the other explanation of a plane has it
};

/// Another explanation of what was seen of late.
struct RecentExplanation {
  int first = 0;                                   ///< state from which on it says something else
  std::vector<ControlState> states;                ///< all from there on, the newest last
  std::vector<std::pair<int, Vector3>> landmarks;  ///< those that came into view since, world frame [units]
  double advantage = 0.0;                          ///< by which its cost, ½ Σ ρ, is lower
};

/// The motion of a plane's image has two explanations, in which the plane's normal and the direction of translation
/// change places (Longuet-Higgins, "The visual ambiguity of a moving plane", 1984); only how the direction changes
/// tells which is true. Where most of what is in view is replaced within a second, new landmarks can hold each other
/// and the motion in the wrong one: it may have had the lower cost when they were few, Gauss-Newton steps don't lead
/// out of it, and within another second the scale is lost.
///
/// So the newest part of the problem, of 32 states, is gone through once more on its own, what was known before being
/// held, with new landmarks beginning on another plane; then both explanations are solved. Returns nothing unless the
/// other one's cost is clearly lower; nor where the part reaches back to `first_state`, the oldest one that is being
/// estimated, where fewer than `enough` landmarks are new or fewer were known before, and where most of those seen in
/// the newest interval were known before.
std::optional<RecentExplanation> explain_otherwise(const FactorGraph& graph, int first_state, int enough,
                                                   SupposedPlane supposed);

}  // namespace evbench::gp_map
