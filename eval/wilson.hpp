#pragma once

#include <cstddef>

namespace evbench {

/// A share and its interval of confidence, from 0 to 1.
struct Share {
  double low, value, high;
};

/// The share of successes in n > 0 trials, with Wilson's interval (1927) of 95 %: unlike the normal approximation it is
/// right for few trials and for shares near 0 and 1.
Share wilson(std::size_t successes, std::size_t n);

}  // namespace evbench
