#pragma once

#include <vector>

namespace evbench::gp_map {

/// Limits how many re-acquired landmarks span any control state. A landmark that is seen before and after a state is a
/// variable of both sides, and the work at that state grows with the square of the number of such landmarks. At most
/// `most` landmarks span a state, however many a front-end re-acquires.
class ReturnBudget {
 public:
  explicit ReturnBudget(int most) : most_(most) {}

  /// May a landmark continue that was last seen in the interval that ends in state `last`, and is seen again in the one
  /// that ends in state `now` > `last`? If so, it counts for the states from `last` to `now` − 1.
  bool spend(int last, int now);

 private:
  int most_;
  std::vector<int> spent_;  ///< by state
};

}  // namespace evbench::gp_map
