#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/smoother/engine/reprojection_errors.hpp"

namespace evbench::smoother {

/// The linearisation points of all variables, the increments from there, and the linearised intervals of the recent
/// past. The graph contains the estimates: estimate = point ⊕ increment for every variable at all times.
class LinearisationPoints {
 public:
  /// `kept`: number of newest intervals whose linearisation is kept; `state_size`: rows of a state's increment.
  LinearisationPoints(int kept, int state_size) : kept_(kept), state_size_(state_size) {}

  void add_state(const ControlState& state);
  void remove_newest_state();
  void add_landmark(const Vector3& position);

  const ControlState& state(int i) const { return states_[index(i)]; }
  const Vector3& landmark(int j) const { return landmarks_[index(j)]; }
  const StateVector& state_delta(int i) const { return state_deltas_[index(i)]; }
  const Vector3& landmark_delta(int j) const { return landmark_deltas_[index(j)]; }

  /// Sets the increment and with it the graph's estimate.
  void set_state_delta(FactorGraph& graph, int i, const StateVector& delta);
  void set_landmark_delta(FactorGraph& graph, int j, const Vector3& delta);

  /// Moves the linearisation point to the estimate.
  void move_state(const FactorGraph& graph, int i);
  void move_landmark(const FactorGraph& graph, int j);

  /// The factors of interval k have changed.
  void invalidate(int k);

  /// Interval k, linearised at the points; valid until the next call.
  const IntervalLinearisation& interval(const FactorGraph& graph, int k);

  /// Distance from state i to the nearest landmark observed in an adjacent interval, as of its last linearisation;
  /// infinite without landmarks.
  double nearest(int i) const {
    return index(i) + 1 < nearest_.size() ? std::min(nearest_[index(i)], nearest_[index(i) + 1]) : nearest_[index(i)];
  }

  /// Reprojection errors as of the last linearisation of each interval.
  ReprojectionErrors& errors() { return errors_; }

  std::int64_t linearised_observations() const { return linearised_observations_; }

 private:
  struct Kept {
    int interval = -1;
    bool valid = false;
    IntervalLinearisation linear;
  };
  Kept& place(int k) { return ring_[index(k) % ring_.size()]; }

  int kept_, state_size_;
  std::vector<ControlState> states_;
  std::vector<Vector3> landmarks_;
  std::vector<StateVector> state_deltas_;
  std::vector<Vector3> landmark_deltas_;
  std::vector<Kept> ring_;       ///< interval k at k mod kept; a miss overwrites
  std::vector<double> nearest_;  ///< by interval
  std::vector<Vector3> positions_;
  ReprojectionErrors errors_;
  std::int64_t linearised_observations_ = 0;
};

}  // namespace evbench::smoother
