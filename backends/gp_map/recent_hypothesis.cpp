#include "backends/gp_map/recent_hypothesis.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "backends/gp_map/engine/engine.hpp"
#include "backends/gp_map/factors.hpp"
#include "backends/gp_map/observation_follower.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {
namespace {

constexpr double kShareInView = 0.75;  ///< of what is in view ...
constexpr double kLongAgo = 2.3;       ///< times as long ago as they came into view: there the newest part begins
constexpr double kLongest = 2.5;       ///< [s] of it
constexpr int kFewestStates = 8, kMostStates = 256;  ///< of it
constexpr int kEnoughObservations = 8000;            ///< of about so many at most, each track's are thinned evenly
constexpr double kKnown = 0.03;            ///< to which landmarks of before are known, as a share of their distance
constexpr double kFirstPoseHeld = 1e-4;    ///< [rad, units] of the pose from which it begins
constexpr double kThere = 0.05;            ///< to which new ones are where they begin, as a share of the usual depth
constexpr double kMostOblique = 4.0;       ///< times nearer or farther than usual: not where the plane is seen edge-on
constexpr double kAdvantage = 10.0;        ///< by which the other explanation's cost must be lower
constexpr int kRecentIterations = 6;       ///< of each explanation, at most ...
constexpr int kReversedIterations = 15;    ///< and of a reversed one, which begins farther from where it leads
constexpr double kRecentTolerance = 3e-3;  ///< relative change of cost with which they end: 10 of some thousands
constexpr int kShare = 34000;  ///< of work at a time: an observation's linearisation is one, a state's elimination ...
constexpr int kStateWork = 100;  ///< so much
constexpr int kStatesAPass = 6;  ///< through the problem, which take as long as an iteration

/// The newest part of some states and the intervals that end in them, or all of it.
struct Part {
  int first = 0, last = 0;       ///< its states and intervals
  std::vector<int> fresh, held;  ///< landmarks seen in it, which came into view in it or before
};

/// So long ago that what came into view since has been replaced once more: a time, however densely states stand.
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

std::optional<Part> newest_part(const FactorGraph& graph, const StateRange& states, std::size_t enough, bool young) {
  Part part;
  part.last = states.newest;
  const bool everything = young && states.oldest == 0 && states.newest < kMostStates;
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
  if (2 * known > std::ssize(now)) return std::nullopt;  // what is known holds the rest
  return part;
}

/// As a problem of its own, its landmarks in this order. The pose before it is held; where there is none, the first
/// pose and the scale.
FactorGraph problem_of(const FactorGraph& graph, const Part& part) {
  FactorGraph problem;
  problem.camera = graph.camera;
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

std::optional<HypothesisSearch> HypothesisSearch::begin(const FactorGraph& graph, const StateRange& states,
                                                          int enough, StructureHypothesis supposed, bool young) {
  auto part = newest_part(graph, states, index(enough), young);
  if (!part) return std::nullopt;
  FactorGraph problem = problem_of(graph, *part);
  auto beginning = suppose(supposed, problem, part->fresh.size());
  if (!beginning) return std::nullopt;
  return HypothesisSearch(part->first, static_cast<int>(graph.landmarks.size()), std::move(part->fresh),
                           std::move(problem), std::move(*beginning));
}

Vector3 HypothesisSearch::Beginning::place(int landmark, const Vector3& p, const Vector3& ray) const {
  const double nearest = usual / kMostOblique, farthest = usual * kMostOblique;
  if (!depths.empty()) return p + std::clamp(depths[index(landmark)], nearest, farthest) * ray;
  const double toward = normal.dot(ray), away = normal.dot(point - p);
  return p + (toward * away > 0.0 ? std::clamp(away / toward, nearest, farthest) : farthest) * ray;
}

std::optional<HypothesisSearch::Beginning> HypothesisSearch::suppose(StructureHypothesis supposed, const FactorGraph& problem,
                                                                       std::size_t fresh) {
  struct Sight {
    Vector3 p, ray;  // of depth 1
  };
  std::vector<Sight> sights;
  std::vector<double> depths;  // of those that lie before the camera, and of all
  std::vector<double> of_each;
  for (std::size_t j = 0; j < fresh; ++j) {
    const FactorGraph::Landmark& landmark = problem.landmarks[j];
    const SE3& T = problem.states[index(landmark.intervals.front())].T;
    const double depth = (T.inverse() * landmark.position).z();
    of_each.push_back(depth);
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
      supposed == StructureHypothesis::dual_plane ? Vector3(end.p - begin.p) : Vector3(begin.R().col(2) + end.R().col(2));
  if (supposed != StructureHypothesis::reversal) return Beginning{normal.normalized(), middle, usual, {}};
  for (double& depth : of_each) depth = depth > 0.0 ? usual * usual / depth : usual;
  return Beginning{normal.normalized(), middle, usual, std::move(of_each)};
}

HypothesisSearch::HypothesisSearch(int first, int landmarks_then, std::vector<int> fresh, FactorGraph problem,
                                     Beginning beginning)
    : first_(first),
      landmarks_then_(landmarks_then),
      fresh_(std::move(fresh)),
      problem_(std::move(problem)),
      beginning_(std::move(beginning)),
      passes_(std::max(1, kShare / work_of(problem_))),
      through_(problem_.camera, problem_.qc, problem_.loss),
      in_engine_(problem_.landmarks.size(), -1) {
  through_.add_state(problem_.states.front());
  through_.add_pose_prior(problem_.pose_priors.front());
}

bool HypothesisSearch::go_on() {
  for (int i = 0; i < passes_; ++i) {
    if (!pass()) return false;
  }
  return true;
}

/// Linearises the observations about once. False when there is nothing left to do.
bool HypothesisSearch::pass() {
  const int states = static_cast<int>(problem_.states.size());
  if (!other_) {
    const int until = std::min(states, gone_through_ + 1 + kStatesAPass);
    while (gone_through_ + 1 < until) add_state(++gone_through_);
    if (until == states) begin_solving();
    return true;
  }
  if (!present_) {
    if (solve(*other_)) return true;
    if (!(cost_ + kAdvantage < evaluate(problem_).total())) return false;
    const int held = std::min(1, first_);
    found_ = RecentHypothesis{
        first_, {other_->graph().states.begin() + held, other_->graph().states.end()}, {}, -cost_, landmarks_then_};
    for (std::size_t j = 0; j < fresh_.size(); ++j) {
      found_->landmarks.emplace_back(fresh_[j], other_->graph().landmarks[j].position);
    }
    present_.emplace(std::move(problem_), EngineOptions{});
    return true;
  }
  if (solve(*present_)) return true;
  found_->advantage += cost_;
  if (!(found_->advantage > kAdvantage)) found_.reset();
  return false;
}

/// What comes into view with it begins where it is supposed to.
void HypothesisSearch::add_state(int k) {
  through_.set_next_qc(problem_.qcs[index(k)]);
  add_extrapolated_state(through_, problem_.states[index(k)].t);
  for (const auto& group : problem_.intervals[index(k)].groups()) {
    const auto observations = problem_.intervals[index(k)].of(group);
    int& j = in_engine_[index(group.landmark)];
    if (j < 0 && index(group.landmark) < fresh_.size()) {
      const SE3& T = through_.graph().states.back().T;
      const Vector3 place =
          beginning_.place(group.landmark, T.p, T.R() * problem_.camera.ray(observations.front().pixel));
      j = through_.add_landmark(place, {place, kThere * beginning_.usual});
    } else if (j < 0) {
      const FactorGraph::Landmark& landmark = problem_.landmarks[index(group.landmark)];
      j = through_.add_landmark(landmark.position, landmark.prior);
    }
    for (const Observation& z : observations) through_.add_observation(j, z);
  }
  through_.update();
}

/// The problem itself, with its expansions and without what held new landmarks to their beginnings.
void HypothesisSearch::begin_solving() {
  through_.settle();
  FactorGraph other = problem_;
  other.states = through_.graph().states;
  for (std::size_t j = 0; j < in_engine_.size(); ++j) {
    if (in_engine_[j] >= 0) other.landmarks[j].position = through_.graph().landmarks[index(in_engine_[j])].position;
  }
  to_held_scale(other);
  other_.emplace(std::move(other), EngineOptions{});
}

/// One iteration. False, and its cost known, after the last one.
bool HypothesisSearch::solve(Engine& engine) {
  const auto summary = engine.optimise(1, kRecentTolerance);
  cost_ = summary.final_cost;
  const bool vain = summary.final_cost == summary.initial_cost;
  const int most = beginning_.depths.empty() ? kRecentIterations : kReversedIterations;
  const bool last = summary.converged || vain || ++iterations_ == most;
  if (last) iterations_ = 0;
  return !last;
}

void RecentHypothesis::place_in(Engine& engine) const {
  const FactorGraph& graph = engine.graph();
  const int end = first + static_cast<int>(states.size());
  const auto before = [&](int k) { return graph.states[index(k)].T; };
  const SE3 along = states.back().T * before(end - 1).inverse();
  for (int j = 0; j < std::ssize(graph.landmarks); ++j) {
    const FactorGraph::Landmark& landmark = graph.landmarks[index(j)];
    if (landmark.intervals.empty() || landmark.intervals.back() < first) continue;
    if (j < landmarks_then && landmark.intervals.front() < end) continue;  // those of since may have been seen before
    const int k = landmark.intervals.back();
    const SE3 motion = k < end ? states[index(k - first)].T * before(k).inverse() : along;
    engine.place_landmark(j, motion * landmark.position);
  }
  for (int k = end; k < std::ssize(graph.states); ++k) {
    ControlState state = graph.states[index(k)];
    state.T = along * state.T;
    engine.place_state(k, state);
  }
  for (int k = first; k < end; ++k) engine.place_state(k, states[index(k - first)]);
  for (const auto& [j, position] : landmarks) engine.place_landmark(j, position);
}

}  // namespace evbench::gp_map
