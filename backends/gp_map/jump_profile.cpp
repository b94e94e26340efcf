#include "backends/gp_map/jump_profile.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "core/support/index.hpp"

namespace evbench::gp_map {
namespace {

constexpr std::size_t kMoments = 3;  ///< candidate times of a sudden jump,
constexpr double kApart = 0.1;       ///< [s] apart

/// The number of landmarks that are seen both before each interval from `first` on, and in it or after it.
std::vector<int> ties(const FactorGraph& graph, int first, const std::set<int>& left_out) {
  std::vector<int> result(graph.states.size() - index(first), 0);
  for (int j = 0; j < std::ssize(graph.landmarks); ++j) {
    const FactorGraph::Landmark& landmark = graph.landmarks[index(j)];
    if (!landmark.alive || landmark.intervals.empty() || left_out.contains(j)) continue;
    const int from = std::max(first, landmark.intervals.front() + 1);
    for (int k = from; k <= landmark.intervals.back(); ++k) ++result[index(k - first)];
  }
  return result;
}

JumpProfile spread(const FactorGraph& graph, int first, std::span<const int> ties) {
  JumpProfile result;
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < ties.size(); ++i) {
    const std::size_t k = index(first) + i;
    const double loose = 1.0 / std::max(1, ties[i]);
    sum += loose * loose * (graph.states[k].t - graph.states[k - 1].t);
    result.push_back(sum);
  }
  result.push_back(sum);
  for (double& share : result) share /= sum;
  return result;
}

/// The intervals with the fewest ties, counted from `first`.
std::vector<int> loosest(const FactorGraph& graph, int first, std::span<const int> ties) {
  std::vector<int> order(ties.size() - 1), result;
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](int i) { return ties[index(i)]; });
  const auto t = [&](int i) { return graph.states[index(first + i)].t; };
  for (const int i : order) {
    const bool is_near = std::ranges::any_of(result, [&](int other) { return std::abs(t(other) - t(i)) < kApart; });
    if (result.size() < kMoments && !is_near) result.push_back(i);
  }
  return result;
}

}  // namespace

std::vector<JumpProfile> jump_profiles(const FactorGraph& graph, int first, const std::set<int>& left_out) {
  const std::vector<int> tied = ties(graph, first, left_out);
  std::vector<JumpProfile> result;
  for (const int i : loosest(graph, first, tied)) {
    std::fill_n(result.emplace_back(tied.size(), 1.0).begin(), i, 0.0);
  }
  result.push_back(spread(graph, first, tied));
  return result;
}

}  // namespace evbench::gp_map
