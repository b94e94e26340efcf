#include "core/smoother/engine/linearisation_points.hpp"

#include <cmath>

namespace evbench::smoother {

void LinearisationPoints::add_state(const ControlState& state) {
  states_.push_back(state);
  state_deltas_.emplace_back(StateVector::Zero(state_size_));
  nearest_.push_back(std::numeric_limits<double>::infinity());
  if (ring_.empty()) ring_.resize(index(kept_));
}

void LinearisationPoints::remove_newest_state() {
  invalidate(static_cast<int>(states_.size()) - 1);
  errors_.remove(static_cast<int>(states_.size()) - 1);
  states_.pop_back();
  state_deltas_.pop_back();
  nearest_.pop_back();
}

void LinearisationPoints::add_landmark(const Vector3& position) {
  landmarks_.push_back(position);
  landmark_deltas_.push_back(Vector3::Zero());
}

void LinearisationPoints::set_state_delta(FactorGraph& graph, int i, const StateVector& delta) {
  state_deltas_[index(i)] = delta;
  // Without an increment it is the point itself: a retraction rounds, and a step that is taken back must leave nothing.
  graph.states[index(i)] = delta.isZero(0.0) ? states_[index(i)] : states_[index(i)].retract(delta);
}

void LinearisationPoints::set_landmark_delta(FactorGraph& graph, int j, const Vector3& delta) {
  landmark_deltas_[index(j)] = delta;
  graph.landmarks[index(j)].position = landmarks_[index(j)] + delta;
}

void LinearisationPoints::move_state(const FactorGraph& graph, int i) {
  states_[index(i)] = graph.states[index(i)];
  state_deltas_[index(i)].setZero();
  invalidate(i);
  invalidate(i + 1);
}

void LinearisationPoints::move_landmark(const FactorGraph& graph, int j) {
  const FactorGraph::Landmark& landmark = graph.landmarks[index(j)];
  landmarks_[index(j)] = landmark.position;
  landmark_deltas_[index(j)].setZero();
  for (const int k : landmark.intervals) invalidate(k);
}

void LinearisationPoints::invalidate(int k) {
  Kept& kept = place(k);
  if (kept.interval == k) kept.valid = false;
}

const IntervalLinearisation& LinearisationPoints::interval(const FactorGraph& graph, int k) {
  Kept& kept = place(k);
  if (kept.interval == k && kept.valid) return kept.linear;
  const IntervalObservations& observations = graph.intervals[index(k)];
  positions_.clear();
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& group : observations.groups()) {
    positions_.push_back(landmarks_[index(group.landmark)]);
    nearest = std::min(nearest, (positions_.back() - states_[index(k)].T.p).squaredNorm());
  }
  nearest_[index(k)] = std::sqrt(nearest);
  linearise_interval({graph.camera, graph.loss, graph.motion_prior, graph.qcs[index(k)], graph.expansions[index(k)],
                      states_[index(k - 1)], states_[index(k)], observations, positions_},
                     kept.linear);
  linearised_observations_ += static_cast<std::int64_t>(observations.all().size());
  errors_.set(k, kept.linear.couplings);
  kept.interval = k;
  kept.valid = true;
  return kept.linear;
}

}  // namespace evbench::smoother
