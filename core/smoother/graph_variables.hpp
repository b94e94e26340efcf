#pragma once

#include <vector>

#include "core/smoother/sparse_minimiser.hpp"

namespace evbench::smoother {

/// Offsets of a graph's variables in the vector of all; −1: landmarks without observations.
struct GraphLayout {
  static constexpr int kLandmarkSize = 3;

  int state_size = 0;
  int size = 0;
  std::vector<int> state_offset, landmark_offset;

  explicit GraphLayout(const FactorGraph& graph);
};

/// Adds all factors of the graph, linearised at its estimate.
void add_factors(const FactorGraph& graph, const GraphLayout& layout, NormalEquations& equations);

/// Moves the graph's estimate by its part of δ.
void apply_step(FactorGraph& graph, const GraphLayout& layout, const Eigen::VectorXd& step);

/// The values that a step changes, to undo it.
class GraphEstimate {
 public:
  explicit GraphEstimate(const FactorGraph& graph);
  void restore(FactorGraph& graph) const;

 private:
  std::vector<ControlState> states_;
  std::vector<Vector3> positions_;
};

}  // namespace evbench::smoother
