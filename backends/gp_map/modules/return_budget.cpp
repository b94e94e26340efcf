#include "backends/gp_map/modules/return_budget.hpp"

#include <algorithm>

#include "core/support/index.hpp"

namespace evbench::gp_map {

bool ReturnBudget::spend(int last, int now) {
  if (spent_.size() < index(now)) spent_.resize(index(now), 0);
  const auto from = spent_.begin() + last, to = spent_.begin() + now;
  if (std::any_of(from, to, [&](int spent) { return spent >= most_; })) return false;
  std::for_each(from, to, [](int& spent) { ++spent; });
  return true;
}

}  // namespace evbench::gp_map
