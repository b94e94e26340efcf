#include "core/smoother/engine/reprojection_errors.hpp"

#include <limits>

namespace evbench::smoother {

std::vector<ReprojectionErrors::Part>& ReprojectionErrors::parts(int k) {
  if (intervals_.size() <= index(k)) intervals_.resize(index(k) + 1);
  return intervals_[index(k)];
}

void ReprojectionErrors::count(const std::vector<Part>& parts, int sign) {
  for (const Part& part : parts) {
    if (totals_.size() <= index(part.landmark)) totals_.resize(index(part.landmark) + 1);
    ErrorSum& total = totals_[index(part.landmark)];
    total.px += sign * part.sum.px;
    total.count += sign * part.sum.count;
    total.behind += sign * part.sum.behind;
  }
}

void ReprojectionErrors::set(int k, const std::vector<IntervalLinearisation::Coupling>& couplings) {
  remove(k);
  for (const auto& coupling : couplings) parts(k).push_back({coupling.landmark, coupling.error});
  count(parts(k), 1);
}

void ReprojectionErrors::take(const FactorGraph& graph, int k) {
  remove(k);
  const std::vector<ErrorSum> sums = reprojection_errors(graph, k);
  const auto& groups = graph.intervals[index(k)].groups();
  for (std::size_t i = 0; i < sums.size(); ++i) parts(k).push_back({groups[i].landmark, sums[i]});
  count(parts(k), 1);
}

void ReprojectionErrors::remove(int k) {
  count(parts(k), -1);
  parts(k).clear();
}

void ReprojectionErrors::settle(int k) { parts(k) = std::vector<Part>(); }

double ReprojectionErrors::mean(int landmark) const {
  if (totals_.size() <= index(landmark) || totals_[index(landmark)].count == 0) return 0.0;
  const ErrorSum& total = totals_[index(landmark)];
  return total.behind > 0 ? std::numeric_limits<double>::infinity() : total.px / total.count;
}

}  // namespace evbench::smoother
