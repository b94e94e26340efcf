#pragma once

#include <utility>
#include <vector>

#include "backends/gp_map/engine/engine.hpp"

namespace evbench::gp_map {

/// Between two control states, follows every observation (the paper's per-event updates): a state stands ahead of the
/// data, and it and the one before are brought to what the observations in the interval between them ask for.
class ObservationFollower {
 public:
  /// Puts a state ahead, at this time, unless there is one already.
  void open(Engine& engine, double ahead);

  void follow(Engine& engine, int landmark, const Observation& observation);

  /// The next control state is to stand at t: where the state ahead stands later, it is taken back there, and what has
  /// been followed is added again.
  void close(Engine& engine, double t);

 private:
  bool open_ = false;
  std::vector<std::pair<int, Observation>> followed_;
};

/// The newest state's motion goes on to time t (paper, Algorithm 1: extrapolation of the GP).
void add_extrapolated_state(Engine& engine, double t);

}  // namespace evbench::gp_map
