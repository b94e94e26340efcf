#pragma once

#include <algorithm>
#include <vector>

#include "backends/gp_map/engine/root_factor.hpp"

namespace evbench::gp_map {

/// One observation, linearised: whitened residual and its derivatives by landmark and by both states of its interval.
struct ObservationRows {
  Vector2 e = Vector2::Zero();
  Matrix23 landmark = Matrix23::Zero();
  Eigen::Matrix<double, 2, 24> states = Eigen::Matrix<double, 2, 24>::Zero();
};

/// The factor of what is alive while an interval (n, n+1) is open: the root after stage n with state n+1 besides, and
/// the right-hand side as one more row. An observation changes it by two rotations of a vector through its columns, in
/// O(rows²), and both newest states are solved from its last rows alone.
class LiveFactor {
 public:
  /// `open`: the motion prior of the open interval and what else has been observed in it so far. False when singular.
  bool build(const Root& root, int newest, const IntervalLinearisation& open);

  /// Whether it is that of the interval that ends in this state.
  bool is_of(int newest) const { return newest_ == newest; }
  void drop() { newest_ = -1; }

  /// Whether a landmark was in the root from which it was built. The root may have become another one since.
  bool has(int landmark) const { return slot_of(landmark) < static_cast<int>(occupants_.size()); }

  /// An observation of a landmark that it has.
  void add(int landmark, const ObservationRows& rows, double weight);

  /// The increments of states n and n+1.
  Vector24 solve_states() const;

 private:
  /// Where it was in that root; beyond all slots where it was not.
  int slot_of(int landmark) const {
    return static_cast<int>(std::ranges::find(occupants_, landmark) - occupants_.begin());
  }

  int newest_ = -1;
  RootFactor factor_;
  std::vector<int> occupants_;  ///< of that root's slots
  Buffer v_, w_;
};

}  // namespace evbench::gp_map
