#include "backends/gp_map/recent_explanation.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>

#include "backends/gp_map/engine/engine.hpp"
#include "backends/gp_map/factors.hpp"
#include "backends/gp_map/observation_follower.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {
namespace {

constexpr int kStates = 32;                ///< of late
constexpr int kEnoughObservations = 8000;  ///< of about so many at most, each track's are thinned evenly
constexpr double kKnown = 0.03;            ///< to which landmarks of before are known, as a share of their distance
constexpr double kHeld = 1e-4;             ///< [rad, units] of the pose from which it begins
constexpr double kOnPlane = 0.05;     ///< to which new ones are on the plane at first, as a share of the usual depth
constexpr double kMostOblique = 4.0;  ///< times nearer or farther than usual: not where the plane is seen edge-on
constexpr double kAdvantage = 10.0;   ///< by which the other explanation's cost must be lower
constexpr int kIterations = 6;        ///< of each explanation, at most
constexpr double kTolerance = 3e-3;   ///< relative change of cost with which they end: 10 of some thousands

/// The newest part of a problem.
struct Part {
  int first = 0;                 ///< its intervals are those from this one on
  std::vector<int> fresh, held;  ///< landmarks seen in it, which came into view in it or before
};

std::optional<Part> newest_part(const FactorGraph& graph, int first_state, std::size_t enough) {
  Part part;
  part.first = static_cast<int>(graph.states.size()) - kStates;
  if (part.first <= first_state + 1) return std::nullopt;
  for (int j = 0; j < std::ssize(graph.landmarks); ++j) {
    const std::vector<int>& seen = graph.landmarks[index(j)].intervals;
    if (!seen.empty() && seen.back() >= part.first) (seen.front() < part.first ? part.held : part.fresh).push_back(j);
  }
  if (part.fresh.size() < enough || part.held.size() < enough) return std::nullopt;
  const auto& now = graph.intervals.back().groups();
  const auto known = std::ranges::count_if(
      now, [&](const auto& group) { return graph.landmarks[index(group.landmark)].intervals.front() < part.first; });
  if (2 * known > std::ssize(now)) return std::nullopt;  // what is known holds the rest
  return part;
}

/// As a problem of its own, its landmarks in this order; the state before it is held.
FactorGraph problem_of(const FactorGraph& graph, const Part& part) {
  FactorGraph problem;
  problem.camera = graph.camera;
  problem.loss = graph.loss;
  for (int k = part.first - 1; k < std::ssize(graph.states); ++k) {
    problem.qc = graph.qcs[index(k)];
    problem.add_state(graph.states[index(k)]);
    problem.expansions.back() = graph.expansions[index(k)];
  }
  const SE3& begin = problem.states.front().T;
  problem.pose_priors.push_back({0, begin, Vector6::Constant(kHeld)});
  int observations = 0;
  for (int k = part.first; k < std::ssize(graph.states); ++k) {
    observations += static_cast<int>(graph.intervals[index(k)].all().size());
  }
  const int every = 1 + observations / kEnoughObservations;
  const auto add = [&](int landmark, const LandmarkPrior& prior) {
    const FactorGraph::Landmark& l = graph.landmarks[index(landmark)];
    const int j = problem.add_landmark(l.position, prior);
    int seen = 0;
    for (const int k : l.intervals) {
      if (k < part.first) continue;
      for (const Observation& z : graph.intervals[index(k)].of(landmark)) {
        if (seen++ % every == 0) problem.add_observation(j, z);
      }
    }
  };
  for (const int j : part.fresh) add(j, graph.landmarks[index(j)].prior);
  for (const int j : part.held) {
    const Vector3& position = graph.landmarks[index(j)].position;
    add(j, {position, kKnown * (position - begin.p).norm()});
  }
  return problem;
}

/// A plane through the middle of what is new.
struct Plane {
  Vector3 normal, point;
  double usual;  ///< depth

  /// Where a ray from p, of depth 1, meets it, within bounds.
  Vector3 meets(const Vector3& p, const Vector3& ray) const {
    const double toward = normal.dot(ray), away = normal.dot(point - p);
    const double most = kMostOblique * usual;
    return p + (toward * away > 0.0 ? std::clamp(away / toward, usual / kMostOblique, most) : most) * ray;
  }
};

/// None where what is new lies behind the camera, or in it.
std::optional<Plane> suppose(SupposedPlane supposed, const FactorGraph& problem, std::size_t fresh) {
  struct Sight {
    Vector3 p, ray;  // of depth 1
  };
  std::vector<Sight> sights;
  std::vector<double> depths;
  for (std::size_t j = 0; j < fresh; ++j) {
    const FactorGraph::Landmark& landmark = problem.landmarks[j];
    const SE3& T = problem.states[index(landmark.intervals.front())].T;
    const double depth = (T.inverse() * landmark.position).z();
    if (!(depth > 0.0)) continue;
    depths.push_back(depth);
    sights.push_back({T.p, (landmark.position - T.p) / depth});
  }
  if (depths.empty()) return std::nullopt;
  const double usual = median(std::move(depths));
  Vector3 middle = Vector3::Zero();
  for (const Sight& sight : sights) middle += (sight.p + usual * sight.ray) / static_cast<double>(sights.size());
  if (!middle.allFinite()) return std::nullopt;
  const SE3 &begin = problem.states.front().T, &end = problem.states.back().T;
  const Vector3 normal =
      supposed == SupposedPlane::dual ? Vector3(end.p - begin.p) : Vector3(begin.R().col(2) + end.R().col(2));
  return Plane{normal.normalized(), middle, usual};
}

/// The same problem, its estimates from going through it once, without expansions: what comes into view begins on the
/// plane.
FactorGraph from_plane(const FactorGraph& problem, std::size_t fresh, const Plane& plane) {
  Engine engine(problem.camera, problem.qc, problem.loss);
  engine.add_state(problem.states.front());
  engine.add_pose_prior(problem.pose_priors.front());
  FactorGraph result = problem;
  std::vector<int> in_engine(problem.landmarks.size(), -1);  // the engine's numbers
  for (int k = 1; k < std::ssize(problem.states); ++k) {
    engine.set_next_qc(problem.qcs[index(k)]);
    add_extrapolated_state(engine, problem.states[index(k)].t);
    for (const auto& group : problem.intervals[index(k)].groups()) {
      const auto observations = problem.intervals[index(k)].of(group);
      int& j = in_engine[index(group.landmark)];
      if (j < 0 && index(group.landmark) < fresh) {
        const SE3& T = engine.graph().states.back().T;
        const Vector3 place = plane.meets(T.p, T.R() * problem.camera.ray(observations.front().pixel));
        j = engine.add_landmark(place, {place, kOnPlane * plane.usual});
      } else if (j < 0) {
        const FactorGraph::Landmark& landmark = problem.landmarks[index(group.landmark)];
        j = engine.add_landmark(landmark.position, landmark.prior);
      }
      for (const Observation& z : observations) engine.add_observation(j, z);
    }
    engine.update();
  }
  engine.settle();
  result.states = engine.graph().states;
  for (std::size_t j = 0; j < in_engine.size(); ++j) {
    if (in_engine[j] >= 0) result.landmarks[j].position = engine.graph().landmarks[index(in_engine[j])].position;
  }
  return result;
}

/// Solves it and returns its cost.
double solve(FactorGraph& problem) {
  Engine engine(std::move(problem), {});
  const double cost = engine.optimise(kIterations, kTolerance).final_cost;
  problem = engine.graph();
  return cost;
}

}  // namespace

std::optional<RecentExplanation> explain_otherwise(const FactorGraph& graph, int first_state, int enough,
                                                   SupposedPlane supposed) {
  const auto part = newest_part(graph, first_state, index(enough));
  if (!part) return std::nullopt;
  FactorGraph present = problem_of(graph, *part);
  const auto plane = suppose(supposed, present, part->fresh.size());
  if (!plane) return std::nullopt;
  FactorGraph other = from_plane(present, part->fresh.size(), *plane);
  const double cost = solve(other);
  if (!(cost + kAdvantage < evaluate(present).total())) return std::nullopt;
  const double advantage = solve(present) - cost;
  if (!(advantage > kAdvantage)) return std::nullopt;
  RecentExplanation result{part->first, {other.states.begin() + 1, other.states.end()}, {}, advantage};
  for (std::size_t j = 0; j < part->fresh.size(); ++j) {
    result.landmarks.emplace_back(part->fresh[j], other.landmarks[j].position);
  }
  return result;
}

}  // namespace evbench::gp_map
