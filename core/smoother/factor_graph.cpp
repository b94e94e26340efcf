#include "core/smoother/factor_graph.hpp"

#include <algorithm>
#include <cmath>

#include "core/smoother/factors.hpp"

namespace evbench::smoother {

void IntervalObservations::add(int landmark, const Observation& observation) {
  auto group = std::lower_bound(groups_.begin(), groups_.end(), landmark,
                                [](const Group& g, int wanted) { return g.landmark < wanted; });
  if (group == groups_.end() || group->landmark != landmark) {
    const int at = group == groups_.end() ? static_cast<int>(observations_.size()) : group->begin;
    group = groups_.insert(group, Group{landmark, at, at});
  }
  const auto end = observations_.begin() + group->end;
  const auto at = std::upper_bound(observations_.begin() + group->begin, end, observation.t,
                                   [](double t, const Observation& other) { return t < other.t; });
  observations_.insert(at, observation);
  ++group->end;
  for (auto later = group + 1; later != groups_.end(); ++later) {
    ++later->begin;
    ++later->end;
  }
}

int IntervalObservations::remove(int landmark, double from) {
  const auto group = std::ranges::find(groups_, landmark, &Group::landmark);
  if (group == groups_.end()) return 0;
  const auto end = observations_.begin() + group->end;
  const auto begin = std::lower_bound(observations_.begin() + group->begin, end, from,
                                      [](const Observation& z, double t) { return z.t < t; });
  const int count = static_cast<int>(end - begin);
  observations_.erase(begin, end);
  group->end -= count;
  for (auto later = group + 1; later != groups_.end(); ++later) {
    later->begin -= count;
    later->end -= count;
  }
  if (group->begin == group->end) groups_.erase(group);
  return count;
}

void IntervalObservations::scale_sigmas(int landmark, double factor) {
  const auto group = std::ranges::find(groups_, landmark, &Group::landmark);
  for (int i = group->begin; i < group->end; ++i) {
    Whitening& whitening = observations_[index(i)].whitening;
    whitening = whitening.scaled(1.0 / factor);
  }
}

std::span<const Observation> IntervalObservations::of(int landmark) const {
  const auto group = std::ranges::lower_bound(groups_, landmark, {}, &Group::landmark);
  if (group == groups_.end() || group->landmark != landmark) return {};
  return of(*group);
}

void FactorGraph::add_state(const ControlState& state) {
  states.push_back(state);
  intervals.emplace_back();
  qcs.push_back(qc);
  expansions.push_back(0.0);
}

void FactorGraph::remove_newest_state() {
  const int newest = static_cast<int>(states.size()) - 1;
  drop_observations(newest);
  intervals.pop_back();
  qcs.pop_back();
  expansions.pop_back();
  states.pop_back();
  const auto on_newest = [&](const auto& prior) { return prior.state == newest; };
  std::erase_if(pose_priors, on_newest);
  std::erase_if(velocity_priors, on_newest);
}

int FactorGraph::add_landmark(const Vector3& position, const LandmarkPrior& prior) {
  landmarks.push_back({position, prior, {}, true});
  return static_cast<int>(landmarks.size()) - 1;
}

void FactorGraph::remove_landmark(int landmark) {
  Landmark& removed = landmarks[index(landmark)];
  for (const int k : removed.intervals) observation_count_ -= intervals[index(k)].remove(landmark);
  removed.intervals.clear();
  removed.alive = false;
  if (std::erase(anchor.landmarks, landmark) > 0) anchor_scale(anchor.origin, anchor.landmarks);
}

void FactorGraph::anchor_scale(const Vector3& origin, std::vector<int> anchors) {
  anchor.origin = origin;
  anchor.landmarks = std::move(anchors);
  anchor.mean_nearness = 0.0;
  if (anchor.landmarks.empty()) return;
  const auto count = static_cast<double>(anchor.landmarks.size());
  double log_distances = 0.0;
  for (const int j : anchor.landmarks) log_distances += std::log((landmarks[index(j)].position - origin).norm());
  anchor.unit = std::exp(log_distances / count);
  anchor.mean_nearness = mean_nearness(*this);
  anchor.change = 0.0;
  for (const int j : anchor.landmarks) {
    const double nearness = anchor.nearness(landmarks[index(j)].position);
    anchor.change += nearness * (1.0 - nearness) / count;
  }
}

void FactorGraph::remove_observations(int landmark, double from) {
  std::erase_if(landmarks[index(landmark)].intervals, [&](int k) {
    if (states[index(k)].t < from) return false;
    observation_count_ -= intervals[index(k)].remove(landmark, from);
    return intervals[index(k)].of(landmark).empty();
  });
}

void FactorGraph::scale_sigmas(int landmark, double scale) {
  Landmark& scaled = landmarks[index(landmark)];
  for (const int k : scaled.intervals) intervals[index(k)].scale_sigmas(landmark, scale / scaled.sigma_scale);
  scaled.sigma_scale = scale;
}

Observation FactorGraph::scaled(int landmark, const Observation& given) const {
  return {given.t, given.pixel, given.whitening.scaled(1.0 / landmarks[index(landmark)].sigma_scale)};
}

int FactorGraph::interval_of(double t) const {
  if (states.size() < 2 || t < states.front().t || t > states.back().t) return -1;
  const auto right = std::lower_bound(states.begin(), states.end(), t,
                                      [](const ControlState& state, double time) { return state.t < time; });
  return std::max(1, static_cast<int>(right - states.begin()));
}

int FactorGraph::first_state_after(double t) const {
  return static_cast<int>(std::ranges::upper_bound(states, t, {}, &ControlState::t) - states.begin());
}

bool FactorGraph::add_observation(int landmark, const Observation& observation) {
  const int k = interval_of(observation.t);
  if (k < 0) return false;
  intervals[index(k)].add(landmark, scaled(landmark, observation));
  ++observation_count_;
  std::vector<int>& seen = landmarks[index(landmark)].intervals;
  const auto at = std::lower_bound(seen.begin(), seen.end(), k);
  if (at == seen.end() || *at != k) seen.insert(at, k);
  return true;
}

void FactorGraph::drop_observations(int k) {
  IntervalObservations& interval = intervals[index(k)];
  for (const auto& group : interval.groups()) {
    std::vector<int>& seen = landmarks[index(group.landmark)].intervals;
    std::erase(seen, k);
    if (seen.empty()) seen.shrink_to_fit();
  }
  observation_count_ -= static_cast<int>(interval.all().size());
  interval = IntervalObservations();
}

}  // namespace evbench::smoother
