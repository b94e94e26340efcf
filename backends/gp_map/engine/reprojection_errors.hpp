#pragma once

#include <vector>

#include "backends/gp_map/factors.hpp"

namespace evbench::gp_map {

/// The mean reprojection error of each landmark over all its observations, those that have been marginalised included:
/// kept as sums by interval, which cost nothing to renew where an interval is linearised anyway.
class ReprojectionErrors {
 public:
  /// The sums of an interval, as it has been linearised.
  void set(int k, const std::vector<IntervalLinearisation::Coupling>& couplings);
  /// The same at a graph's estimate.
  void take(const FactorGraph& graph, int k);
  /// The interval has been taken back.
  void remove(int k);
  /// The interval doesn't change any more: only the means have it.
  void settle(int k);

  /// [px]; infinite when an observation has the landmark behind the camera, 0 without observations.
  double mean(int landmark) const;

 private:
  struct Part {
    int landmark;
    ErrorSum sum;
  };
  std::vector<Part>& parts(int k);
  void count(const std::vector<Part>& parts, int sign);

  std::vector<std::vector<Part>> intervals_;
  std::vector<ErrorSum> totals_;  ///< by landmark
};

}  // namespace evbench::gp_map
