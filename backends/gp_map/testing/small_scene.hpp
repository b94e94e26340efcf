#pragma once

#include <vector>

#include "backends/gp_map/smoother.hpp"

namespace evbench::gp_map::testing {

/// Two states at rest at the origin, 0.1 s apart, and landmarks at these depths, all seen at 0.05 and 0.1 s.
inline FactorGraph small_scene(const std::vector<double>& depths) {
  FactorGraph graph;
  graph.camera = {200.0, 200.0, 120.0, 90.0};
  for (const double t : {0.0, 0.1}) graph.add_state({t, SE3(), Vector6::Zero()});
  graph.pose_priors.push_back({0, SE3(), Vector6::Constant(1e-3)});
  graph.velocity_priors.push_back({0, Vector6::Zero(), Vector6::Constant(1e-3)});
  for (std::size_t j = 0; j < depths.size(); ++j) {
    const double x = -0.3 + 0.6 * static_cast<double>(j) / static_cast<double>(depths.size());
    const Vector3 position = depths[j] * Vector3(x, 0.1, 1.0);
    const int landmark = graph.add_landmark(position, {position, 0.1});
    for (const double t : {0.05, 0.1}) graph.add_observation(landmark, {t, graph.camera.project(position), 1.0});
  }
  return graph;
}

}  // namespace evbench::gp_map::testing
