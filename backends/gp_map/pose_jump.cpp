#include "backends/gp_map/pose_jump.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "backends/gp_map/factors.hpp"
#include "backends/gp_map/jump_profile.hpp"
#include "backends/gp_map/observation_follower.hpp"
#include "core/geometry/seen_point.hpp"
#include "core/geometry/solve_symmetric.hpp"
#include "core/structure/point_image.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {
namespace {

constexpr double kDisplaced = 0.8;        ///< [px] below this median displacement nothing is wrong
constexpr double kRemaining = 0.5;        ///< largest share of it that remains after the displacement is undone
constexpr std::size_t kEnough = 5;        ///< landmarks that one motion must explain,
constexpr double kMajority = 2.0 / 3.0;   ///< and their share of all,
constexpr double kExplained = 2.0;        ///< within this many pixels
constexpr double kStillInPlace = 3.0;     ///< [px] with a larger error, a landmark is not in its place
constexpr double kNewestPoseHeld = 1e-3;  ///< [rad, units] sigma of the held newest pose,
constexpr double kAhead = 1e-3;           ///< [s] at a state this much later
constexpr double kInPlace = 0.75;  ///< quantile of the last times in place: where rotation and translation cancel, some
                                   ///< landmarks are in their places though the camera is not
constexpr int kDragged = 50;       ///< states before the jump that may move a little, too
constexpr int kHoldingSteps = 8, kSettlingSteps = 4;
/// Allowed increase of the cost: in all cases, and for each landmark that one motion explains beyond those that may be
/// chance. Observations that contradicted the present estimate were removed from the problem, so its cost is too low.
constexpr double kIncrease = 10.0, kIncreasePerLandmark = 60.0;

/// The interval at a time.
GpInterval interval_at(const FactorGraph& graph, double t) {
  const std::size_t k = index(graph.interval_of(t));
  return {graph.states[k - 1], graph.states[k]};
}

/// A displacement of the world frame, T ← D T, and the landmarks that are in their places with it.
struct Displacement {
  SE3 motion;
  double median_error = 0.0;  ///< of all landmarks with it [px]
  std::vector<Reappearance> explained;
};

/// Finds the smallest displacement that explains the landmarks, by robust least squares. It is no resection, because
/// each landmark was seen from its own pose, and the camera turns while they are re-acquired. The steps ignore this
/// rotation: with exact derivatives more displacements are found, and estimates end worse.
std::optional<Displacement> find_displacement(const FactorGraph& graph, std::span<const Reappearance> seen) {
  constexpr int kIterations = 12, kWideIterations = 4;
  constexpr double kWide = 8.0;   // [px], the loss's width in the first ones
  constexpr double kUsual = 0.1;  // [rad, median depths]
  std::vector<SE3> poses;
  for (const Reappearance& z : seen) poses.push_back(interval_at(graph, z.t).pose(z.t));
  const SE3& frame = poses.back();  // all are nearly the same
  Displacement result;
  const auto point = [&](std::size_t i) -> Vector3 {
    return (result.motion * poses[i]).inverse() * graph.landmarks[index(seen[i].landmark)].position;
  };
  std::vector<double> depths;
  for (std::size_t i = 0; i < seen.size(); ++i) depths.push_back(point(i).z());
  const double depth = median(std::move(depths));
  Vector6 smallness = Vector6::Constant(1.0 / (kUsual * kUsual));
  smallness.tail<3>() /= depth * depth;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const double width = iteration < kWideIterations ? kWide : kExplained;
    Matrix6 H = smallness.asDiagonal();
    Vector6 b = -smallness.cwiseProduct(se3::log(frame.inverse() * result.motion * frame));
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const Vector3 q = point(i);
      if (!(q.z() > 0.0)) continue;
      const Vector2 e = graph.camera.project(q) - seen[i].pixel;
      const Matrix26 J = graph.camera.project_jacobian(q) * seen_point_jacobian(q);
      const double weight = BoundedLoss{width}.weight(e.squaredNorm());
      H += weight * J.transpose() * J;
      b -= weight * J.transpose() * e;
    }
    const Vector6 step = solve_symmetric(H, b);
    if (!step.allFinite()) return std::nullopt;
    result.motion = result.motion * frame * se3::exp(step) * frame.inverse();
  }
  std::vector<double> errors;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Vector3 q = point(i);
    constexpr double kBehind = std::numeric_limits<double>::infinity();
    errors.push_back(q.z() > 0.0 ? (graph.camera.project(q) - seen[i].pixel).norm() : kBehind);
    if (errors.back() < kExplained) result.explained.push_back(seen[i]);
  }
  result.median_error = median(std::move(errors));
  return result;
}

bool are_most(std::ptrdiff_t some, std::size_t all) {
  return static_cast<double>(some) >= kMajority * static_cast<double>(all);
}

/// A displacement that explains most landmarks that are off their expected places, and enough of them.
std::optional<Displacement> find_jump(const FactorGraph& graph, std::span<const Reappearance> seen) {
  if (seen.size() < kEnough) return std::nullopt;
  std::vector<double> errors;
  for (const Reappearance& z : seen) errors.push_back(reappearance_error(graph, z));
  const double offset = median(std::move(errors));
  if (offset < kDisplaced) return std::nullopt;
  auto found = find_displacement(graph, seen);
  if (!found || !(found->median_error < kRemaining * offset)) return std::nullopt;
  if (found->explained.size() < kEnough || !are_most(std::ssize(found->explained), seen.size())) return std::nullopt;
  return found;
}

/// Cost of the intervals from `first` on.
double cost_since(const FactorGraph& graph, int first) {
  double cost = 0.0;
  for (int k = first; k < std::ssize(graph.intervals); ++k) cost += interval_cost(graph, k);
  return cost;
}

/// The newest part of an estimate, to restore it.
class Estimate {
 public:
  /// States from `first` on, and the landmarks that are seen there.
  Estimate(const FactorGraph& graph, int first)
      : first_(first), states_(graph.states.begin() + first, graph.states.end()) {
    for (int j = 0; j < std::ssize(graph.landmarks); ++j) {
      const FactorGraph::Landmark& landmark = graph.landmarks[index(j)];
      const bool seen = !landmark.intervals.empty() && landmark.intervals.back() >= first;
      if (landmark.alive && seen) landmarks_.emplace_back(j, landmark.position);
    }
  }

  const std::vector<std::pair<int, Vector3>>& landmarks() const { return landmarks_; }

  void place_in(Engine& engine) const {
    const FactorGraph& graph = engine.graph();
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const int k = first_ + static_cast<int>(i);
      const ControlState& now = graph.states[index(k)];
      const bool moved = now.T.p != states_[i].T.p || now.T.q.coeffs() != states_[i].T.q.coeffs();
      if (moved || now.velocity != states_[i].velocity) engine.set_state(k, states_[i]);
    }
    for (const auto& [j, position] : landmarks_) {
      if (graph.landmarks[index(j)].position != position) engine.set_landmark(j, position);
    }
  }

 private:
  int first_;
  std::vector<ControlState> states_;
  std::vector<std::pair<int, Vector3>> landmarks_;
};

/// Moves each state, and the landmarks mostly seen since, by its share of a motion. Re-acquired landmarks stay in
/// place.
void displace(Engine& engine, const Estimate& estimate, int first, const SE3& motion, const std::set<int>& seen_again,
              const JumpProfile& share) {
  const FactorGraph& graph = engine.graph();
  const Vector6 increment = se3::log(motion);
  const auto motion_at = [&](int k) { return se3::exp(share[index(k - first)] * increment); };
  for (const auto& [j, position] : estimate.landmarks()) {
    if (seen_again.contains(j)) continue;
    const std::vector<int>& intervals = graph.landmarks[index(j)].intervals;
    if (intervals.empty()) continue;  // marginalised meanwhile
    const int middle = intervals[intervals.size() / 2];
    if (middle >= first) engine.set_landmark(j, motion_at(middle) * position);
  }
  for (int k = first; k < std::ssize(graph.states); ++k) {
    ControlState state = graph.states[index(k)];
    state.T = motion_at(k) * state.T;
    engine.set_state(k, state);
  }
}

/// Gauss-Newton steps with the newest pose held.
void converge_with_held_pose(Engine& engine) {
  add_extrapolated_state(engine, engine.graph().states.back().t + kAhead);
  const int ahead = static_cast<int>(engine.graph().states.size()) - 1;
  engine.add_pose_prior({ahead, engine.graph().states.back().T, Vector6::Constant(kNewestPoseHeld)});
  for (int step = 0; step < kHoldingSteps; ++step) engine.update();
  engine.remove_newest_state();
  engine.set_state(ahead - 1,
                   engine.graph().states.back());  // redoes its stage, whose landmarks were in the removed one
}

/// The newest interval before the re-acquisition in which the landmark was seen in its place; `oldest` if none is
/// newer. A short re-acquisition off its place before does not count.
int last_in_place(const FactorGraph& graph, const Reappearance& seen, int oldest) {
  const FactorGraph::Landmark& landmark = graph.landmarks[index(seen.landmark)];
  for (auto k = landmark.intervals.rbegin(); k != landmark.intervals.rend() && *k > oldest; ++k) {
    if (*k > seen.last) continue;
    const Observation& z = graph.intervals[index(*k)].of(seen.landmark).back();
    if (reprojection_error(interval_at(graph, z.t), landmark.position, z, graph.camera) < kStillInPlace) return *k;
  }
  return oldest;
}

}  // namespace

double reappearance_error(const FactorGraph& graph, const Reappearance& seen) {
  const Vector3& position = graph.landmarks[index(seen.landmark)].position;
  return reprojection_error(interval_at(graph, seen.t), position, {seen.t, seen.pixel, 1.0}, graph.camera);
}

bool correct_pose_jump(Engine& engine, std::span<const Reappearance> seen) {
  const FactorGraph& graph = engine.graph();
  const auto found = find_jump(graph, seen);
  if (!found) return false;
  constexpr int kSettling = 64;  // states that may be marginalised during the test
  const int oldest = engine.first_state() > 0 ? engine.first_state() + kSettling : 1;
  std::vector<double> last;
  for (const Reappearance& z : found->explained) last.push_back(last_in_place(graph, z, oldest));
  const int first = 1 + static_cast<int>(order_statistic(std::move(last), kInPlace));
  if (first + 1 >= std::ssize(graph.states)) return false;

  std::set<int> seen_again;
  for (const Reappearance& z : seen) seen_again.insert(z.landmark);
  const int dragged = std::max(oldest, first - kDragged);
  const Estimate before(graph, dragged);
  const auto beyond_enough = static_cast<double>(found->explained.size() - kEnough);
  double most = cost_since(graph, dragged) + kIncrease + kIncreasePerLandmark * beyond_enough;
  std::optional<Estimate> other;
  for (const JumpProfile& jump_profile : jump_profiles(graph, first, seen_again)) {
    before.place_in(engine);
    displace(engine, before, first, found->motion, seen_again, jump_profile);
    converge_with_held_pose(engine);
    for (int step = 0; step < kSettlingSteps; ++step) engine.update();
    if (engine.first_state() >= dragged) {  // its beginning is marginalised by now
      other.reset();
      break;
    }
    const auto there = std::ranges::count_if(
        found->explained, [&](const Reappearance& z) { return reappearance_error(graph, z) < kStillInPlace; });
    const double cost = cost_since(graph, dragged);
    if (!are_most(there, found->explained.size()) || !(cost < most)) continue;
    most = cost;
    other.emplace(graph, dragged);
  }
  (other ? *other : before).place_in(engine);
  engine.update();
  return other.has_value();
}

}  // namespace evbench::gp_map
