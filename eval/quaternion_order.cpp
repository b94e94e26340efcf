#include "eval/quaternion_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/geometry/nearest_rotation.hpp"
#include "core/geometry/so3.hpp"
#include "core/support/index.hpp"
#include "core/support/median.hpp"

namespace evbench {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kLargestTurn = 30.0 * kDegree;  // large enough to determine the axis, small enough to limit drift
constexpr double kSmallestTurn = 2.0 * kDegree;
constexpr double kBetter = 0.25;    // relative to the difference in the order as read
constexpr double kFitsWell = 0.33;  // relative to the turn
constexpr std::size_t kPoses = 500;
constexpr std::size_t kOrders = 4;

using Turn = std::pair<std::size_t, std::size_t>;

/// Turns between poses that are as close in time as a sufficient turn allows.
std::vector<Turn> find_turns(std::span<const PosePair> pairs, double& angle) {
  const auto turned = [&](std::size_t i, std::size_t j) {
    return pairs[i].ground_truth.q.angularDistance(pairs[j].ground_truth.q);
  };
  const std::size_t stride = std::max<std::size_t>(1, pairs.size() / kPoses);
  double largest = 0.0;
  for (std::size_t i = 0; i < pairs.size(); i += stride) largest = std::max(largest, turned(0, i));
  angle = std::min(kLargestTurn, 0.5 * largest);
  std::vector<Turn> turns;
  if (angle < kSmallestTurn) return turns;
  for (std::size_t i = 0; i < pairs.size(); i += stride) {
    std::size_t j = i + stride;
    while (j < pairs.size() && turned(i, j) < angle) j += stride;
    if (j < pairs.size()) turns.emplace_back(i, j);
  }
  return turns;
}

/// The quaternion with its columns read in the order that is `shift` further in QuaternionOrder.
Eigen::Quaterniond reordered(const Eigen::Quaterniond& q, std::size_t shift) {
  Eigen::Quaterniond result;
  std::ranges::rotate_copy(q.coeffs(), q.coeffs().begin() + static_cast<std::ptrdiff_t>(shift),
                           result.coeffs().begin());
  return result;
}

/// Rotation vectors of the turns, in the body's frame.
std::vector<Vector3> rotations(std::span<const PosePair> pairs, const std::vector<Turn>& turns, bool of_ground_truth,
                               std::size_t shift) {
  std::vector<Vector3> result;
  for (const auto& [i, j] : turns) {
    const auto q = [&](std::size_t k) {
      return reordered(of_ground_truth ? pairs[k].ground_truth.q : pairs[k].estimate.q, shift);
    };
    result.push_back(so3::log(q(i).conjugate() * q(j)));
  }
  return result;
}

/// [rad]
double difference(const std::vector<Vector3>& a, const std::vector<Vector3>& b, const Matrix3& a_from_b) {
  std::vector<double> angles;
  for (std::size_t i = 0; i < a.size(); ++i) {
    angles.push_back(so3::exp(a[i]).angularDistance(so3::exp(a_from_b * b[i])));
  }
  return median(angles);
}

/// The best rotation between the body frames; none if all turns are about one axis.
std::optional<Matrix3> frame_between(const std::vector<Vector3>& a, const std::vector<Vector3>& b) {
  constexpr double kSecondAxis = 0.02;
  Matrix3 covariance = Matrix3::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) covariance += a[i] * b[i].transpose();
  const NearestRotation best = nearest_rotation(covariance);
  if (best.values[1] < kSecondAxis * best.values[0]) return std::nullopt;
  return best.R;
}

QuaternionOrder later(QuaternionOrder order, std::size_t shift) {
  const std::size_t first = index(QuaternionOrder::xyzw);
  return static_cast<QuaternionOrder>(first + (index(order) - first + shift) % kOrders);
}

/// The turns of both trajectories in each order.
struct Rotations {
  std::array<std::vector<Vector3>, kOrders> ground_truth, estimate;
};

std::optional<BetterOrder> same_frames(const Rotations& turns, const QuaternionOrders& read) {
  const auto difference_of = [&](std::size_t truth, std::size_t estimate) {
    return difference(turns.ground_truth[truth], turns.estimate[estimate], Matrix3::Identity());
  };
  const auto best_of = [&](bool of_ground_truth) -> std::optional<BetterOrder> {
    const QuaternionOrder order = of_ground_truth ? read.ground_truth : read.estimate;
    if (order == QuaternionOrder::automatic) return std::nullopt;
    std::optional<BetterOrder> best;
    for (std::size_t shift = 1; shift < kOrders; ++shift) {
      const double error = of_ground_truth ? difference_of(shift, 0) : difference_of(0, shift);
      if (best && best->reordered_deg <= error) continue;
      best = BetterOrder{.of_ground_truth = of_ground_truth, .order = later(order, shift), .reordered_deg = error};
    }
    return best;
  };
  const std::optional<BetterOrder> truth = best_of(true), estimate = best_of(false);
  std::optional<BetterOrder> best = estimate ? estimate : truth;
  if (truth && estimate) {
    // Both fit if the world frames are equal: then the one whose order is assumed is reported.
    const bool truth_is_suspect = read.ground_truth_is_assumed && !read.estimate_is_assumed;
    constexpr double kRounding = 1e-9;  // [rad]: both are exact
    const bool is_truth = truth_is_suspect ? truth->reordered_deg < 2.0 * estimate->reordered_deg + kRounding
                                           : truth->reordered_deg + kRounding < 0.5 * estimate->reordered_deg;
    if (is_truth) best = truth;
  }
  if (best) best->as_read_deg = difference_of(0, 0);
  return best;
}

/// If the body frames differ, an order can't be distinguished from the one two further: returns the more common one.
std::optional<BetterOrder> other_frames(const Rotations& turns, const QuaternionOrders& read) {
  const auto difference_of = [&](std::size_t estimate) -> std::optional<double> {
    const auto frame = frame_between(turns.ground_truth[0], turns.estimate[estimate]);
    if (!frame) return std::nullopt;
    return difference(turns.ground_truth[0], turns.estimate[estimate], *frame);
  };
  const auto as_read = difference_of(0), reordered = difference_of(1);
  const bool of_ground_truth =
      read.estimate == QuaternionOrder::automatic ||
      (read.ground_truth != QuaternionOrder::automatic && read.ground_truth_is_assumed && !read.estimate_is_assumed);
  const QuaternionOrder order = of_ground_truth ? read.ground_truth : read.estimate;
  if (!as_read || !reordered || order == QuaternionOrder::automatic) return std::nullopt;
  return BetterOrder{.of_ground_truth = of_ground_truth,
                     .order = std::min(later(order, 1), later(order, 3)),
                     .frames_differ = true,
                     .as_read_deg = *as_read,
                     .reordered_deg = *reordered};
}

}  // namespace

std::optional<BetterOrder> better_quaternion_order(std::span<const PosePair> pairs, const QuaternionOrders& read) {
  double angle = 0.0;
  const std::vector<Turn> turns = find_turns(pairs, angle);
  if (turns.empty()) return std::nullopt;
  Rotations all;
  for (std::size_t shift = 0; shift < kOrders; ++shift) {
    all.ground_truth[shift] = rotations(pairs, turns, true, shift);
    all.estimate[shift] = rotations(pairs, turns, false, shift);
  }
  for (auto better : {same_frames(all, read), other_frames(all, read)}) {
    if (!better || better->as_read_deg < kDegree || better->reordered_deg > kBetter * better->as_read_deg ||
        better->reordered_deg > kFitsWell * angle) {
      continue;
    }
    better->turn_deg = angle / kDegree;
    better->as_read_deg /= kDegree;
    better->reordered_deg /= kDegree;
    return better;
  }
  return std::nullopt;
}

}  // namespace evbench
