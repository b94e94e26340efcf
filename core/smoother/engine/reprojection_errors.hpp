#pragma once

#include <vector>

#include "core/smoother/factors.hpp"

namespace evbench::smoother {

/// The mean reprojection error of each landmark over all its observations, including marginalised ones. It is kept as
/// sums by interval, which cost nothing to update where an interval is linearised anyway.
class ReprojectionErrors {
 public:
  /// Sets the sums of an interval from its linearisation.
  void set(int k, const std::vector<IntervalLinearisation::Coupling>& couplings);
  /// Computes them at a graph's estimate.
  void take(const FactorGraph& graph, int k);
  /// The interval has been removed.
  void remove(int k);
  /// The interval no longer changes: only the means keep it.
  void settle(int k);

  /// [px]; infinite if an observation has the landmark behind the camera, 0 without observations.
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

}  // namespace evbench::smoother
