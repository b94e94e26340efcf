#include "backends/gp_map/reprojection_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "backends/gp_map/factors.hpp"

namespace evbench::gp_map {

void ReprojectionErrors::Sum::add(const Sum& other, int sign) {
  px += sign * other.px;
  count += sign * other.count;
  behind += sign * other.behind;
}

double ReprojectionErrors::mean(int landmark) const {
  if (index(landmark) >= totals_.size() || totals_[index(landmark)].count == 0) return 0.0;
  const Sum& total = totals_[index(landmark)];
  return total.behind > 0 ? std::numeric_limits<double>::infinity() : total.px / total.count;
}

void ReprojectionErrors::update(const Engine& engine) {
  constexpr double kTolerance = 0.2;  // [px]
  const FactorGraph& graph = engine.graph();
  const double tolerance = kTolerance / graph.camera.fx;
  const int newest = static_cast<int>(graph.states.size()) - 1;
  for (; intervals_.size() > graph.states.size(); intervals_.pop_back()) replace(intervals_.back().sums, {});
  const int known = static_cast<int>(intervals_.size());
  intervals_.resize(graph.states.size());
  totals_.resize(graph.landmarks.size());
  moved_.resize(graph.landmarks.size(), 0.0);
  for (; settled_ <= engine.first_state(); ++settled_) intervals_[index(settled_)].sums = {};

  for (const Engine::Change& change : engine.changes()) {
    const int i = change.variable.index;
    if (change.variable.kind == Variable::Kind::landmark) {
      moved_[index(i)] += change.size;
      if (totals_[index(i)].count == 0 || moved_[index(i)] > tolerance) take_landmark(graph, i);
      continue;
    }
    for (int k = std::max(i, settled_); k <= std::min(i + 1, newest); ++k) {
      intervals_[index(k)].moved += change.size;
      if (intervals_[index(k)].moved > tolerance) take_interval(graph, k);
    }
  }
  // The newest two states may have followed single observations besides.
  for (int k = std::max(settled_, std::min(known, newest - 1)); k <= newest; ++k) take_interval(graph, k);
}

ReprojectionErrors::Sum ReprojectionErrors::take(const FactorGraph& graph, const GpInterval& interval, int landmark,
                                                 std::span<const Observation> observations) {
  Sum sum{landmark};
  for (const Observation& z : observations) {
    const double error = reprojection_error(interval, graph.landmarks[index(landmark)].position, z, graph.camera);
    if (std::isfinite(error)) sum.px += error;
    sum.behind += std::isfinite(error) ? 0 : 1;
    ++sum.count;
  }
  return sum;
}

void ReprojectionErrors::take_interval(const FactorGraph& graph, int k) {
  const IntervalObservations& observations = graph.intervals[index(k)];
  std::vector<Sum> sums;
  if (k > 0) {
    const GpInterval interval(graph.states[index(k - 1)], graph.states[index(k)]);
    for (const auto& group : observations.groups()) {
      sums.push_back(take(graph, interval, group.landmark, observations.of(group)));
    }
  }
  replace(intervals_[index(k)].sums, std::move(sums));
  intervals_[index(k)].moved = 0.0;
}

void ReprojectionErrors::take_landmark(const FactorGraph& graph, int landmark) {
  for (const int k : graph.landmarks[index(landmark)].intervals) {
    if (k < settled_) continue;
    std::vector<Sum>& sums = intervals_[index(k)].sums;
    const GpInterval interval(graph.states[index(k - 1)], graph.states[index(k)]);
    const Sum sum = take(graph, interval, landmark, graph.intervals[index(k)].of(landmark));
    auto place = std::ranges::lower_bound(sums, landmark, {}, &Sum::landmark);
    if (place == sums.end() || place->landmark != landmark) place = sums.insert(place, Sum{landmark});
    totals_[index(landmark)].add(*place, -1);
    totals_[index(landmark)].add(*place = sum, 1);
  }
  moved_[index(landmark)] = 0.0;
}

void ReprojectionErrors::replace(std::vector<Sum>& sums, std::vector<Sum> by) {
  for (const Sum& sum : sums) totals_[index(sum.landmark)].add(sum, -1);
  for (const Sum& sum : by) totals_[index(sum.landmark)].add(sum, 1);
  sums = std::move(by);
}

}  // namespace evbench::gp_map
