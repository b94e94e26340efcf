#include "backends/gp_map/factor_graph.hpp"

#include <algorithm>

#include "backends/gp_map/factors.hpp"

namespace evbench::gp_map {

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

void IntervalObservations::remove(int landmark) {
  const auto group =
      std::find_if(groups_.begin(), groups_.end(), [&](const Group& g) { return g.landmark == landmark; });
  if (group == groups_.end()) return;
  const int count = group->end - group->begin;
  observations_.erase(observations_.begin() + group->begin, observations_.begin() + group->end);
  for (auto later = groups_.erase(group); later != groups_.end(); ++later) {
    later->begin -= count;
    later->end -= count;
  }
}

bool IntervalObservations::remove(int landmark, double t) {
  const auto group =
      std::find_if(groups_.begin(), groups_.end(), [&](const Group& g) { return g.landmark == landmark; });
  if (group == groups_.end()) return false;
  const auto end = observations_.begin() + group->end;
  const auto found = std::find_if(observations_.begin() + group->begin, end, [&](const auto& z) { return z.t == t; });
  if (found == end) return false;
  observations_.erase(found);
  --group->end;
  for (auto later = group + 1; later != groups_.end(); ++later) {
    --later->begin;
    --later->end;
  }
  if (group->begin == group->end) groups_.erase(group);
  return true;
}

void FactorGraph::add_state(const ControlState& state) {
  states.push_back(state);
  intervals.emplace_back();
}

void FactorGraph::remove_newest_state() {
  const int newest = static_cast<int>(states.size()) - 1;
  for (const auto& group : intervals.back().groups()) {
    std::erase(landmarks[static_cast<std::size_t>(group.landmark)].intervals, newest);
  }
  intervals.pop_back();
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
  Landmark& removed = landmarks[static_cast<std::size_t>(landmark)];
  for (const int k : removed.intervals) intervals[static_cast<std::size_t>(k)].remove(landmark);
  removed.intervals.clear();
  removed.alive = false;
  if (std::erase(anchor.landmarks, landmark) > 0) anchor_scale(anchor.origin, anchor.landmarks);
}

void FactorGraph::anchor_scale(const Vector3& origin, std::vector<int> anchors) {
  anchor.origin = origin;
  anchor.landmarks = std::move(anchors);
  anchor.mean_log_distance = mean_log_distance(*this);
}

int FactorGraph::interval_of(double t) const {
  if (states.size() < 2 || t < states.front().t || t > states.back().t) return -1;
  const auto right = std::lower_bound(states.begin(), states.end(), t,
                                      [](const ControlState& state, double time) { return state.t < time; });
  return std::max(1, static_cast<int>(right - states.begin()));
}

bool FactorGraph::add_observation(int landmark, const Observation& observation) {
  const int k = interval_of(observation.t);
  if (k < 0) return false;
  intervals[static_cast<std::size_t>(k)].add(landmark, observation);
  std::vector<int>& seen = landmarks[static_cast<std::size_t>(landmark)].intervals;
  const auto at = std::lower_bound(seen.begin(), seen.end(), k);
  if (at == seen.end() || *at != k) seen.insert(at, k);
  return true;
}

bool FactorGraph::remove_observation(int landmark, double t) {
  const int k = interval_of(t);
  if (k < 0 || !intervals[static_cast<std::size_t>(k)].remove(landmark, t)) return false;
  const auto& groups = intervals[static_cast<std::size_t>(k)].groups();
  if (std::ranges::find(groups, landmark, &IntervalObservations::Group::landmark) == groups.end()) {
    std::erase(landmarks[static_cast<std::size_t>(landmark)].intervals, k);
  }
  return true;
}

int FactorGraph::observation_count() const {
  std::size_t count = 0;
  for (const IntervalObservations& interval : intervals) count += interval.all().size();
  return static_cast<int>(count);
}

Cost evaluate(const FactorGraph& graph) {
  Cost cost;
  for (std::size_t k = 1; k < graph.states.size(); ++k) {
    const GpInterval interval(graph.states[k - 1], graph.states[k]);
    cost.motion_prior += motion_prior_cost(interval, graph.qc);
    const IntervalObservations& observations = graph.intervals[k];
    for (const auto& group : observations.groups()) {
      const Vector3 landmark = graph.landmarks[static_cast<std::size_t>(group.landmark)].position;
      for (int i = group.begin; i < group.end; ++i) {
        const Observation& z = observations.all()[static_cast<std::size_t>(i)];
        cost.measurements +=
            0.5 * graph.loss.value(reprojection_residual(interval, landmark, z, graph.camera).squaredNorm());
      }
    }
  }
  for (const PosePrior& prior : graph.pose_priors) {
    cost.priors += 0.5 * residual(prior, graph.states[static_cast<std::size_t>(prior.state)]).squaredNorm();
  }
  for (const VelocityPrior& prior : graph.velocity_priors) {
    cost.priors += 0.5 * residual(prior, graph.states[static_cast<std::size_t>(prior.state)]).squaredNorm();
  }
  for (const FactorGraph::Landmark& landmark : graph.landmarks) {
    if (landmark.alive) cost.priors += 0.5 * residual(landmark.prior, landmark.position).squaredNorm();
  }
  if (!graph.anchor.landmarks.empty()) {
    const double e = (mean_log_distance(graph) - graph.anchor.mean_log_distance) / graph.anchor.sigma;
    cost.priors += 0.5 * e * e;
  }
  return cost;
}

double reprojection_mean(const FactorGraph& graph, int landmark) {
  const FactorGraph::Landmark& l = graph.landmarks[static_cast<std::size_t>(landmark)];
  double sum = 0.0;
  int count = 0;
  for (const int k : l.intervals) {
    const auto index = static_cast<std::size_t>(k);
    const GpInterval interval(graph.states[index - 1], graph.states[index]);
    const IntervalObservations& observations = graph.intervals[index];
    for (const auto& group : observations.groups()) {
      if (group.landmark != landmark) continue;
      for (int i = group.begin; i < group.end; ++i) {
        const Observation& z = observations.all()[static_cast<std::size_t>(i)];
        const Vector3 q = interval.pose(z.t).inverse() * l.position;
        if (!(q.z() > 0.0)) return std::numeric_limits<double>::infinity();
        sum += (graph.camera.project(q) - z.pixel).norm();
        ++count;
      }
    }
  }
  return count == 0 ? 0.0 : sum / count;
}

}  // namespace evbench::gp_map
