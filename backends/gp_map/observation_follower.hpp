#pragma once

#include <utility>
#include <vector>

#include "backends/gp_map/smoother.hpp"

namespace evbench::gp_map {

/// Follows every observation between two control states (the paper's per-event updates). A state is placed ahead of the
/// data; this state and the one before are updated by the observations in the interval between them.
class ObservationFollower {
 public:
  /// Adds a state ahead, at this time, unless there is one.
  void open(Smoother& smoother, double ahead);

  void follow(Smoother& smoother, int landmark, const Observation& observation);

  /// The next control state will be at t. If the state ahead is later, it moves to t, and the followed observations are
  /// added again.
  void close(Smoother& smoother, double t);

 private:
  bool open_ = false;
  std::vector<std::pair<int, Observation>> followed_;
};

}  // namespace evbench::gp_map
