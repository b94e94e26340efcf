#include "backends/gp_map/modules/alternative_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "backends/gp_map/observation_follower.hpp"
#include "core/smoother/factors.hpp"
#include "core/smoother/smoother.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {
namespace {

constexpr double kShareInView = 0.75;  ///< of the landmarks in view ...
constexpr double kLongAgo = 2.3;       ///< times as long ago as they came into view, the newest part begins
constexpr double kLongest = 2.5;       ///< [s] its length
constexpr int kFewestStates = 8, kMostStates = 256;  ///< its states
constexpr int kEnoughObservations = 8000;  ///< beyond about so many, each track's observations are thinned evenly
constexpr double kKnown = 0.03;            ///< sigma of older landmarks, as a share of their distance
constexpr double kFirstPoseHeld = 1e-4;    ///< [rad, units] sigma of the pose from which it begins
constexpr double kInitialSigma = 0.05;  ///< sigma of new landmarks' initial positions, as a share of the median depth
constexpr double kMostOblique = 4.0;    ///< largest factor from the median depth, where the plane is edge-on
constexpr double kAdvantage = 10.0;     ///< by which the cost of the alternative must be lower
constexpr int kRecentIterations = 6;    ///< of each estimate, at most
constexpr double kRecentTolerance = 3e-3;  ///< relative change of the cost at which they end: 10 of some thousands
constexpr int kShare = 34000;    ///< work of one share: linearising an observation is one, eliminating a state ...
constexpr int kStateWork = 100;  ///< this much
constexpr int kStatesAPass = 6;  ///< states added in one pass, which takes as long as an iteration

/// The newest part of a range of states, with the intervals that end in them, or all of it.
struct Part {
  int first = 0, last = 0;       ///< its states and intervals
  std::vector<int> fresh, held;  ///< landmarks seen in it: new ones, and older ones
};

/// The first state of the newest part. The part is so long that the landmarks that came into view in it have been
/// replaced once more; it is measured in time, for any density of states.
int newest_parts_first(const FactorGraph& graph, int last) {
  const double now = graph.states[index(last)].t;
  std::vector<double> ages;
  for (const auto& group : graph.intervals[index(last)].groups()) {
    ages.push_back(now - graph.states[index(graph.landmarks[index(group.landmark)].intervals.front())].t);
  }
  const double length =
      ages.empty() ? 0.0 : std::min(kLongest, kLongAgo * order_statistic(std::move(ages), kShareInView));
  return std::clamp(graph.first_state_after(now - length), last + 1 - kMostStates, last + 1 - kFewestStates);
}

std::optional<Part> newest_part(const FactorGraph& graph, const StateRange& states, std::size_t enough,
                                bool tentative) {
  Part part;
  part.last = states.newest;
  const bool everything = tentative && states.oldest == 0 && states.newest < kMostStates;
  if (!everything) part.first = newest_parts_first(graph, part.last);
  if (!everything && part.first <= states.oldest + 1) return std::nullopt;
  for (int j = 0; j < std::ssize(graph.landmarks); ++j) {
    const std::vector<int>& seen = graph.landmarks[index(j)].intervals;
    const auto in_part = std::ranges::lower_bound(seen, part.first);
    if (in_part == seen.end() || *in_part > part.last) continue;
    (seen.front() < part.first ? part.held : part.fresh).push_back(j);
  }
  if (part.fresh.size() < enough) return std::nullopt;
  if (everything) return part;
  if (part.held.size() < enough) return std::nullopt;
  const auto& now = graph.intervals[index(part.last)].groups();
  const auto known = std::ranges::count_if(
      now, [&](const auto& group) { return graph.landmarks[index(group.landmark)].intervals.front() < part.first; });
  if (2 * known > std::ssize(now)) return std::nullopt;  // the older landmarks fix the rest
  return part;
}

/// The part as a problem of its own, with its landmarks in this order. The pose before it is held; if there is none,
/// the first pose and the scale.
FactorGraph problem_of(const FactorGraph& graph, const Part& part) {
  FactorGraph problem;
  problem.camera = graph.camera;
  problem.motion_prior = graph.motion_prior;
  problem.loss = graph.loss;
  for (int k = std::max(0, part.first - 1); k <= part.last; ++k) {
    problem.qc = graph.qcs[index(k)];
    problem.add_state(graph.states[index(k)]);
    problem.expansions.back() = graph.expansions[index(k)];
  }
  const SE3& begin = problem.states.front().T;
  problem.pose_priors.push_back({0, begin, Vector6::Constant(kFirstPoseHeld)});
  int observations = 0;
  for (int k = part.first; k <= part.last; ++k) {
    observations += static_cast<int>(graph.intervals[index(k)].all().size());
  }
  const int every = 1 + observations / kEnoughObservations;
  const auto add = [&](int landmark, const LandmarkPrior& prior) {
    const FactorGraph::Landmark& l = graph.landmarks[index(landmark)];
    const int j = problem.add_landmark(l.position, prior);
    int seen = 0;
    for (const int k : l.intervals) {
      if (k < part.first || k > part.last) continue;
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
  if (part.first == 0) {
    std::vector<int> anchors;
    for (const int j : graph.anchor.landmarks) {
      const auto place = std::ranges::lower_bound(part.fresh, j);
      if (place != part.fresh.end() && *place == j) anchors.push_back(static_cast<int>(place - part.fresh.begin()));
    }
    problem.anchor_scale(graph.anchor.origin, std::move(anchors));
  }
  return problem;
}

int work_of(const FactorGraph& problem) {
  return problem.observation_count() + kStateWork * static_cast<int>(problem.states.size());
}

}  // namespace

std::optional<AlternativeSearch> AlternativeSearch::begin(const FactorGraph& graph, const StateRange& states,
                                                          int enough, StructureHypothesis hypothesis, bool tentative) {
  auto part = newest_part(graph, states, index(enough), tentative);
  if (!part) return std::nullopt;
  FactorGraph problem = problem_of(graph, *part);
  const auto plane = assume_plane(hypothesis, problem, part->fresh.size());
  if (!plane) return std::nullopt;
  return AlternativeSearch(part->first, static_cast<int>(graph.landmarks.size()), std::move(part->fresh),
                           std::move(problem), *plane);
}

Vector3 AlternativeSearch::Plane::place(const Vector3& p, const Vector3& ray) const {
  const double nearest = median_depth / kMostOblique, farthest = median_depth * kMostOblique;
  const double toward = normal.dot(ray), away = normal.dot(point - p);
  return p + (toward * away > 0.0 ? std::clamp(away / toward, nearest, farthest) : farthest) * ray;
}

std::optional<AlternativeSearch::Plane> AlternativeSearch::assume_plane(StructureHypothesis hypothesis,
                                                                        const FactorGraph& problem, std::size_t fresh) {
  struct Sight {
    Vector3 p, ray;  // of depth 1
  };
  std::vector<Sight> sights;
  std::vector<double> depths;  // of landmarks before the camera
  for (std::size_t j = 0; j < fresh; ++j) {
    const FactorGraph::Landmark& landmark = problem.landmarks[j];
    const SE3& T = problem.states[index(landmark.intervals.front())].T;
    const double depth = (T.inverse() * landmark.position).z();
    if (!(depth > 0.0)) continue;
    depths.push_back(depth);
    sights.push_back({T.p, (landmark.position - T.p) / depth});
  }
  if (depths.empty()) return std::nullopt;
  const double median_depth = median(std::move(depths));
  Vector3 middle = Vector3::Zero();
  for (const Sight& sight : sights) middle += (sight.p + median_depth * sight.ray) / static_cast<double>(sights.size());
  if (!middle.allFinite()) return std::nullopt;
  const SE3 &begin = problem.states.front().T, &end = problem.states.back().T;
  const Vector3 normal = hypothesis == StructureHypothesis::dual_plane ? Vector3(end.p - begin.p)
                                                                       : Vector3(begin.R().col(2) + end.R().col(2));
  return Plane{normal.normalized(), middle, median_depth};
}

AlternativeSearch::AlternativeSearch(int first, int landmark_count, std::vector<int> fresh, FactorGraph problem,
                                     const Plane& plane)
    : first_(first),
      landmark_count_(landmark_count),
      fresh_(std::move(fresh)),
      problem_(std::move(problem)),
      plane_(plane),
      passes_(std::max(1, kShare / work_of(problem_))),
      forward_(problem_.camera, problem_.qc, problem_.loss, {}, problem_.motion_prior),
      in_engine_(problem_.landmarks.size(), -1) {
  forward_.add_state(problem_.states.front());
  forward_.add_pose_prior(problem_.pose_priors.front());
}

bool AlternativeSearch::run_share() {
  for (int i = 0; i < passes_; ++i) {
    if (!pass()) return false;
  }
  return true;
}

/// Processes the observations about once. False when the search has ended.
bool AlternativeSearch::pass() {
  const int states = static_cast<int>(problem_.states.size());
  if (!alternative_) {
    const int until = std::min(states, newest_added_ + 1 + kStatesAPass);
    while (newest_added_ + 1 < until) add_state(++newest_added_);
    if (until == states) begin_solving();
    return true;
  }
  if (!present_) {
    if (solve(*alternative_)) return true;
    if (!(cost_ + kAdvantage < evaluate(problem_).total())) return false;
    const int held = std::min(1, first_);
    found_ = AlternativeEstimate{first_,
                                 {alternative_->graph().states.begin() + held, alternative_->graph().states.end()},
                                 {},
                                 -cost_,
                                 landmark_count_};
    for (std::size_t j = 0; j < fresh_.size(); ++j) {
      found_->landmarks.emplace_back(fresh_[j], alternative_->graph().landmarks[j].position);
    }
    present_.emplace(std::move(problem_), SmootherOptions{});
    return true;
  }
  if (solve(*present_)) return true;
  found_->advantage += cost_;
  if (!(found_->advantage > kAdvantage)) found_.reset();
  return false;
}

/// Adds a state. New landmarks begin on the plane.
void AlternativeSearch::add_state(int k) {
  forward_.set_next_qc(problem_.qcs[index(k)]);
  forward_.add_state_at(problem_.states[index(k)].t);
  for (const auto& group : problem_.intervals[index(k)].groups()) {
    const auto observations = problem_.intervals[index(k)].of(group);
    int& j = in_engine_[index(group.landmark)];
    if (j < 0 && index(group.landmark) < fresh_.size()) {
      const SE3& T = forward_.graph().states.back().T;
      const Vector3 place = plane_.place(T.p, T.R() * problem_.camera.ray(observations.front().pixel));
      j = forward_.add_landmark(place, {place, kInitialSigma * plane_.median_depth});
    } else if (j < 0) {
      const FactorGraph::Landmark& landmark = problem_.landmarks[index(group.landmark)];
      j = forward_.add_landmark(landmark.position, landmark.prior);
    }
    for (const Observation& z : observations) forward_.add_observation(j, z);
  }
  forward_.update();
}

/// Begins to solve the problem itself, with its expansions and without the priors that held new landmarks on the
/// plane.
void AlternativeSearch::begin_solving() {
  forward_.update_everything();
  FactorGraph other = problem_;
  other.states = forward_.graph().states;
  for (std::size_t j = 0; j < in_engine_.size(); ++j) {
    if (in_engine_[j] >= 0) other.landmarks[j].position = forward_.graph().landmarks[index(in_engine_[j])].position;
  }
  to_anchored_scale(other);
  alternative_.emplace(std::move(other), SmootherOptions{});
}

/// One iteration. False after the last one; the cost is then known.
bool AlternativeSearch::solve(Smoother& smoother) {
  const auto summary = smoother.optimise(1, kRecentTolerance);
  cost_ = summary.final_cost;
  const bool unchanged = summary.final_cost == summary.initial_cost;
  const bool last = summary.converged || unchanged || ++iterations_ == kRecentIterations;
  if (last) iterations_ = 0;
  return !last;
}

void AlternativeEstimate::place_in(Smoother& smoother) const {
  const FactorGraph& graph = smoother.graph();
  const int end = first + static_cast<int>(states.size());
  const auto before = [&](int k) { return graph.states[index(k)].T; };
  const SE3 along = states.back().T * before(end - 1).inverse();
  for (int j = 0; j < std::ssize(graph.landmarks); ++j) {
    const FactorGraph::Landmark& landmark = graph.landmarks[index(j)];
    if (landmark.intervals.empty() || landmark.intervals.back() < first) continue;
    if (j < landmark_count && landmark.intervals.front() < end) continue;  // newer ones may have been seen before
    const int k = landmark.intervals.back();
    const SE3 motion = k < end ? states[index(k - first)].T * before(k).inverse() : along;
    smoother.set_landmark(j, motion * landmark.position);
  }
  for (int k = end; k < std::ssize(graph.states); ++k) {
    ControlState state = graph.states[index(k)];
    state.T = along * state.T;
    smoother.set_state(k, state);
  }
  for (int k = first; k < end; ++k) smoother.set_state(k, states[index(k - first)]);
  for (const auto& [j, position] : landmarks) smoother.set_landmark(j, position);
}

}  // namespace evbench::gp_map
