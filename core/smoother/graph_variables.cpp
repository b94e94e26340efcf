#include "core/smoother/graph_variables.hpp"

#include <cmath>

#include "core/support/index.hpp"

namespace evbench::smoother {

GraphLayout::GraphLayout(const FactorGraph& graph)
    : state_size(graph.state_size()),
      state_offset(graph.states.size(), -1),
      landmark_offset(graph.landmarks.size(), -1) {
  // Landmarks come first: they are eliminated first.
  for (std::size_t j = 0; j < graph.landmarks.size(); ++j) {
    if (graph.landmarks[j].intervals.empty()) continue;
    landmark_offset[j] = size;
    size += kLandmarkSize;
  }
  for (int& offset : state_offset) {
    offset = size;
    size += state_size;
  }
}

namespace {

void add_interval(const GraphLayout& layout, int k, const IntervalLinearisation& linear, NormalEquations& equations) {
  const int x0 = layout.state_offset[index(k - 1)], x1 = layout.state_offset[index(k)], n = layout.state_size;
  equations.add_block(x0, x0, linear.states.topLeftCorner(n, n));
  equations.add_block(x1, x0, linear.states.bottomLeftCorner(n, n));
  equations.add_block(x1, x1, linear.states.bottomRightCorner(n, n));
  equations.add_gradient(x0, linear.gradient.head(n));
  equations.add_gradient(x1, linear.gradient.tail(n));
  for (const auto& coupling : linear.couplings) {
    const int l = layout.landmark_offset[index(coupling.landmark)];
    equations.add_block(l, l, coupling.landmark_landmark);
    equations.add_block(l, x0, coupling.landmark_states.leftCols(n));
    equations.add_block(l, x1, coupling.landmark_states.rightCols(n));
    equations.add_gradient(l, coupling.gradient);
  }
}

void add_anchor(const FactorGraph& graph, const GraphLayout& layout, NormalEquations& equations) {
  const std::vector<int>& anchors = graph.anchor.landmarks;
  const AnchorLinearisation linear = linearise_anchor(graph);
  for (std::size_t a = 0; a < anchors.size(); ++a) {
    const int row = layout.landmark_offset[index(anchors[a])];
    equations.add_gradient(row, Vector3(linear.e * linear.jacobian[a]));
    for (std::size_t b = 0; b <= a; ++b) {
      const int column = layout.landmark_offset[index(anchors[b])];
      equations.add_block(row, column, Matrix3(linear.jacobian[a] * linear.jacobian[b].transpose()));
    }
  }
}

void add_priors(const FactorGraph& graph, const GraphLayout& layout, NormalEquations& equations) {
  for (std::size_t i = 0; i < graph.states.size(); ++i) {
    const StateSystem system = state_priors(graph, static_cast<int>(i));
    equations.add_block(layout.state_offset[i], layout.state_offset[i], system.H);
    equations.add_gradient(layout.state_offset[i], system.g);
  }
  for (std::size_t j = 0; j < graph.landmarks.size(); ++j) {
    const LandmarkPrior& prior = graph.landmarks[j].prior;
    const int l = layout.landmark_offset[j];
    if (l < 0 || !std::isfinite(prior.sigma)) continue;
    const double information = 1.0 / (prior.sigma * prior.sigma);
    equations.add_block(l, l, Matrix3(information * Matrix3::Identity()));
    equations.add_gradient(l, Vector3(information * (graph.landmarks[j].position - prior.position)));
  }
  add_anchor(graph, layout, equations);
}

}  // namespace

void add_factors(const FactorGraph& graph, const GraphLayout& layout, NormalEquations& equations) {
  IntervalLinearisation linear;
  for (int k = 1; k < static_cast<int>(graph.states.size()); ++k) {
    linearise_interval(graph, k, linear);
    add_interval(layout, k, linear, equations);
  }
  add_priors(graph, layout, equations);
}

void apply_step(FactorGraph& graph, const GraphLayout& layout, const Eigen::VectorXd& step) {
  for (std::size_t i = 0; i < graph.states.size(); ++i) {
    graph.states[i] = graph.states[i].retract(step.segment(layout.state_offset[i], layout.state_size));
  }
  for (std::size_t j = 0; j < graph.landmarks.size(); ++j) {
    if (layout.landmark_offset[j] >= 0) {
      graph.landmarks[j].position += step.segment<GraphLayout::kLandmarkSize>(layout.landmark_offset[j]);
    }
  }
}

GraphEstimate::GraphEstimate(const FactorGraph& graph) : states_(graph.states) {
  positions_.reserve(graph.landmarks.size());
  for (const auto& landmark : graph.landmarks) positions_.push_back(landmark.position);
}

void GraphEstimate::restore(FactorGraph& graph) const {
  graph.states = states_;
  for (std::size_t j = 0; j < positions_.size(); ++j) graph.landmarks[j].position = positions_[j];
}

}  // namespace evbench::smoother
