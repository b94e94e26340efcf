#pragma once

#include <span>
#include <vector>

#include "backends/gp_map/engine/engine.hpp"

namespace evbench::gp_map {

/// The mean reprojection error of each landmark over all its observations, those that have been marginalised included.
/// It is kept as sums by landmark and interval, which are taken anew where the estimate has moved by more than a fifth
/// of a pixel: the cost of an update does not depend on the length of history.
class ReprojectionErrors {
 public:
  /// After each update of the engine.
  void update(const Engine& engine);

  /// [px]; infinite when an observation has the landmark behind the camera, 0 without observations.
  double mean(int landmark) const;

 private:
  struct Sum {
    int landmark = 0;
    double px = 0.0;
    int count = 0, behind = 0;
    void add(const Sum& other, int sign);
  };
  struct Interval {
    std::vector<Sum> sums;  ///< by landmark
    double moved = 0.0;     ///< [rad], by its states since the sums were taken
  };

  static Sum take(const FactorGraph& graph, const GpInterval& interval, int landmark,
                  std::span<const Observation> observations);
  void take_interval(const FactorGraph& graph, int k);
  void take_landmark(const FactorGraph& graph, int landmark);
  void replace(std::vector<Sum>& sums, std::vector<Sum> by);

  std::vector<Interval> intervals_;
  std::vector<Sum> totals_;    ///< by landmark
  std::vector<double> moved_;  ///< [rad], by each landmark since its sums were taken
  int settled_ = 0;            ///< intervals up to here don't change any more: only the totals have them
};

}  // namespace evbench::gp_map
