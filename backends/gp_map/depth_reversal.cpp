#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "backends/gp_map/factors.hpp"
#include "backends/gp_map/gp_map.hpp"
#include "core/support/median.hpp"

// Whether other depths explain better what came into view of late.
namespace evbench::gp_map {
namespace {

constexpr double kOfLate = 1.5;    ///< [s] since which landmarks are new,
constexpr double kTurnover = 2.0;  ///< or since when so many came as so many times those in view
constexpr double kMargin = 10.0;   ///< by which the other explanation's cost must be lower
constexpr int kSteps = 12;         ///< at most, towards it
constexpr int kFewSteps = 3;       ///< at most, in which the present one settles as well
constexpr double kSettled = 1.0;   ///< change of cost with which steps end

struct Seen {
  int landmark = 0;
  int since = 0;  ///< interval
};

/// The landmarks seen in interval `first` or later, the newest one first.
std::vector<Seen> seen_from(const FactorGraph& graph, int first) {
  std::vector<Seen> seen;
  for (int j = 0; j < std::ssize(graph.landmarks); ++j) {
    const std::vector<int>& intervals = graph.landmarks[index(j)].intervals;
    if (!intervals.empty() && intervals.back() >= first) seen.push_back({j, intervals.front()});
  }
  std::ranges::stable_sort(seen, std::greater{}, &Seen::since);
  return seen;
}

double cost_from(const FactorGraph& graph, int first) {
  double cost = 0.0;
  for (int k = first; k < std::ssize(graph.states); ++k) cost += interval_cost(graph, k);
  return cost;
}

/// Steps until the cost of the intervals from `first` on settles; returns that cost.
double settle(Engine& engine, int first, int steps, UpdateSummary& update) {
  double cost = cost_from(engine.graph(), first);
  while (steps-- > 0) {
    update = engine.update();
    const double before = std::exchange(cost, cost_from(engine.graph(), first));
    if (std::abs(before - cost) < kSettled) break;
  }
  return cost;
}

}  // namespace

/// What is nearly flat has two explanations: near and far exchanged, and the motion with them. Where the view turns
/// over within a second, new landmarks, begun from a motion that is known from one side alone, can hold each other and
/// the motion in the wrong one. Gauss-Newton steps don't lead out of it, and within another second the scale is lost.
/// So half-way between two hindsights it is tried whether steps from where all that is new is equally far end better.
void GpMap::reconsider_depths() {
  const double now = graph().states.back().t;
  if (now < next_reconsidering_) return;
  next_reconsidering_ = std::numeric_limits<double>::infinity();
  const int newest = static_cast<int>(graph().states.size()) - 1;
  int first = graph().first_state_after(now - kOfLate);
  std::vector<Seen> seen = seen_from(graph(), first);
  const auto most = static_cast<std::size_t>(kTurnover * static_cast<double>(graph().intervals.back().groups().size()));
  if (most < seen.size()) first = std::max(first, seen[most].since + 1);
  if (first <= engine_->first_state() + 1 || first >= newest) return;
  std::erase_if(seen, [&](const Seen& s) { return graph().landmarks[index(s.landmark)].intervals.back() < first; });
  const auto old = std::ranges::find_if(seen, [&](const Seen& s) { return s.since < first; });

  const SE3 T_camera_world = graph().states[index(first)].T.inverse();
  std::vector<double> depths;
  for (auto s = old; s != seen.end(); ++s) {
    const double z = (T_camera_world * graph().landmarks[index(s->landmark)].position).z();
    if (z > 0.0) depths.push_back(z);
  }
  const int enough = options_.health.min_landmarks;
  if (std::ssize(depths) < enough || old - seen.begin() < enough) return;
  const double depth = median(std::move(depths));

  const double present = settle(*engine_, first, kFewSteps, last_update_);
  const std::vector<ControlState> states(graph().states.begin() + first, graph().states.end());
  std::vector<Vector3> positions;
  for (const Seen& s : seen) positions.push_back(graph().landmarks[index(s.landmark)].position);
  for (auto s = seen.begin(); s != old; ++s) {
    const Observation& z = graph().intervals[index(s->since)].of(s->landmark).front();
    const GpInterval interval(graph().states[index(s->since - 1)], graph().states[index(s->since)]);
    engine_->place_landmark(s->landmark, interval.pose(z.t) * (depth * graph().camera.ray(z.pixel)));
  }
  const double other = settle(*engine_, first, kSteps, last_update_);
  if (!last_update_.rejected && other < present - kMargin) {
    context_.log(fmt::format("{:.3f} s: other depths explain better what came into view of late, by {:.1f}", now,
                             present - other));
    return;
  }
  for (std::size_t i = 0; i < states.size(); ++i) engine_->place_state(first + static_cast<int>(i), states[i]);
  for (std::size_t i = 0; i < seen.size(); ++i) engine_->place_landmark(seen[i].landmark, positions[i]);
  last_update_ = engine_->update();
}

}  // namespace evbench::gp_map
