#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace evbench {

/// Predicts how long runs take from those that are done.
///
/// A run takes as long as the mean of the most similar ones that are done: of the same label if there are any and, of
/// those, with the most values on axes in common.
class RunDurations {
 public:
  /// The properties that a run's duration may depend on.
  struct Traits {
    std::string label;
    std::vector<std::string> values;  ///< "AXIS=VALUE", in the order of the sweep's axes
  };

  void add(const Traits& traits, double seconds);

  /// Expected duration [s]; 0 where no run is done.
  double expected(const Traits& traits) const;

 private:
  struct Done {
    Traits traits;
    double seconds;
  };
  std::vector<Done> done_;
};

/// Time [s] until runs of these durations [s] are done, started in this order, a given number at a time.
double time_left(std::span<const double> seconds, std::size_t at_a_time);

}  // namespace evbench
