#pragma once

#include <vector>

namespace evbench::gp_map {

/// How many landmarks have come back over each control state. One that is seen before a state and after it is a
/// variable of both sides, and the work at that state grows with the square of their number: whatever a front-end
/// finds again, no more than `most` go on over any state.
class ReturnBudget {
 public:
  explicit ReturnBudget(int most) : most_(most) {}

  /// Whether a landmark may go on that was seen last in the interval that ends in state `last`, and is seen again in
  /// the one that ends in state `now` > `last`. If so, it counts over the states from `last` to `now` − 1.
  bool spend(int last, int now);

 private:
  int most_;
  std::vector<int> spent_;  ///< by state
};

}  // namespace evbench::gp_map
