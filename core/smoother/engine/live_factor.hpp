#pragma once

#include <algorithm>
#include <vector>

#include "core/smoother/engine/root_factor.hpp"

namespace evbench::smoother {

/// One linearised observation: whitened residual and its derivatives by the landmark and by both states of its
/// interval.
struct ObservationRows {
  Vector2 e = Vector2::Zero();
  Matrix23 landmark = Matrix23::Zero();
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, 36> states;  ///< empty: no effect
};

/// The factor of everything alive while an interval (n, n+1) is open: the root after stage n extended by state n+1,
/// with the right-hand side as one more row. An observation updates it by two rotations of a vector through its
/// columns, in O(rows²). Both newest states are solved from its last rows alone.
class LiveFactor {
 public:
  /// Builds the factor. `open`: the motion prior of the open interval and its observations so far. False if singular.
  bool build(const Root& root, int newest, const IntervalLinearisation& open);

  /// Does it belong to the interval that ends in this state?
  bool is_of(int newest) const { return newest_ == newest; }
  void drop() { newest_ = -1; }

  /// Was a landmark in the root from which the factor was built? The root may have changed since.
  bool has(int landmark) const { return slot_of(landmark) < static_cast<int>(occupants_.size()); }

  /// Adds an observation of a landmark that it has.
  void add(int landmark, const ObservationRows& rows, double weight);

  /// The increments of states n and n+1.
  PairVector solve_states() const;

 private:
  /// The landmark's slot in that root; beyond all slots if it was not there.
  int slot_of(int landmark) const {
    return static_cast<int>(std::ranges::find(occupants_, landmark) - occupants_.begin());
  }

  int newest_ = -1;
  int state_rows_ = 0;  ///< of both states
  RootFactor factor_;
  std::vector<int> occupants_;  ///< of the slots of that root
  Buffer v_, w_;
};

}  // namespace evbench::smoother
