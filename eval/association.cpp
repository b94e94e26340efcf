#include "eval/association.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace evbench {
namespace {

/// Index of the pose nearest to t, the earlier one of two equally near; of a trajectory that is not empty.
std::size_t nearest_index(const std::vector<StampedPose>& poses, double t) {
  const auto right =
      std::lower_bound(poses.begin(), poses.end(), t, [](const StampedPose& p, double time) { return p.t < time; });
  if (right == poses.begin()) return 0;
  const auto index = static_cast<std::size_t>(right - poses.begin());
  if (right == poses.end()) return index - 1;
  return t - poses[index - 1].t <= right->t - t ? index - 1 : index;
}

constexpr double kFarthest = 1e50;  // [m]: beyond it, products of squares overflow

void check(const PoseTrajectory& trajectory, const char* name) {
  if (trajectory.empty()) throw InputError(fmt::format("the {} has no poses", name));
  for (const StampedPose& pose : trajectory.poses()) {
    if (!std::isfinite(pose.t) || !pose.T.p.allFinite() || !pose.T.q.coeffs().allFinite()) {
      throw InputError(fmt::format("the {}'s pose at {:.6f} s has a value that is not finite", name, pose.t));
    }
    if (const double farthest = pose.T.p.cwiseAbs().maxCoeff(); farthest > kFarthest) {
      throw InputError(fmt::format("the {}'s pose at {:.6f} s is {:.3g} m from the origin; expected at most {:g} m",
                                   name, pose.t, farthest, kFarthest));
    }
  }
}

std::vector<PosePair> nearest_pairs(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate,
                                    const AssociationOptions& options) {
  const bool step_through_ground_truth = estimate.size() > ground_truth.size();
  const std::vector<StampedPose>& steps = (step_through_ground_truth ? ground_truth : estimate).poses();
  const std::vector<StampedPose>& candidates = (step_through_ground_truth ? estimate : ground_truth).poses();
  // Added to the times of `steps` to reach the clock of `candidates`.
  const double offset = step_through_ground_truth ? -options.time_offset : options.time_offset;
  std::vector<PosePair> pairs;
  for (const StampedPose& step : steps) {
    const StampedPose& candidate = candidates[nearest_index(candidates, step.t + offset)];
    if (std::abs(candidate.t - (step.t + offset)) > options.tolerance) continue;
    const StampedPose& truth = step_through_ground_truth ? step : candidate;
    const StampedPose& estimated = step_through_ground_truth ? candidate : step;
    pairs.push_back({estimated.t + options.time_offset, truth.T, estimated.T});
  }
  return pairs;
}

std::vector<PosePair> interpolated_pairs(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate,
                                         const AssociationOptions& options) {
  std::vector<PosePair> pairs;
  for (const StampedPose& estimated : estimate.poses()) {
    const double t = estimated.t + options.time_offset;
    const std::optional<SE3> truth = ground_truth.pose(t);
    const double nearest = ground_truth.poses()[nearest_index(ground_truth.poses(), t)].t;
    if (truth && std::abs(nearest - t) <= options.tolerance) pairs.push_back({t, *truth, estimated.T});
  }
  return pairs;
}

/// The probable unit of a trajectory's times if it is not seconds, else null. Compares its time span with the other's,
/// and the interval of its poses with usual rates. It must have at least two poses.
const char* other_unit(const PoseTrajectory& trajectory, double other_span) {
  const double span = trajectory.end() - trajectory.start();
  const double step = span / static_cast<double>(trajectory.size() - 1);
  for (const auto& [factor, unit] : {std::pair{1e3, "milliseconds"}, {1e6, "microseconds"}, {1e9, "nanoseconds"}}) {
    const bool as_long = span / factor > 0.1 * other_span && span / factor < 10.0 * other_span;
    if (as_long && step / factor > 0.5e-3 && step / factor < 2.0) return unit;
  }
  return nullptr;
}

/// The probable reason why too few poses match.
std::string hint(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate,
                 const AssociationOptions& options) {
  const double start = estimate.start() + options.time_offset;
  const double end = estimate.end() + options.time_offset;
  if (ground_truth.size() > 1 && estimate.size() > 1) {
    if (const char* unit = other_unit(estimate, ground_truth.end() - ground_truth.start())) {
      return fmt::format("the estimate's times look like {}, expected seconds", unit);
    }
    if (const char* unit = other_unit(ground_truth, end - start)) {
      return fmt::format("the ground truth's times look like {}, expected seconds", unit);
    }
  }
  if (end + options.tolerance < ground_truth.start() || start - options.tolerance > ground_truth.end()) {
    return fmt::format(
        "the spans don't overlap: different clocks? an offset of {:.6f} s would make them start together",
        ground_truth.start() - start);
  }
  return "the spans overlap: a larger tolerance or interpolated ground truth may be needed";
}

[[noreturn]] void fail_too_few(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate, std::size_t pairs,
                               const AssociationOptions& options) {
  const double start = estimate.start() + options.time_offset;
  const double end = estimate.end() + options.time_offset;
  throw InputError(fmt::format(
      "{} of the estimate's poses have ground truth within {} s, expected at least {}; the ground truth has {} poses "
      "from "
      "{:.6f} to {:.6f} s, the estimate {} from {:.6f} to {:.6f} s; {}",
      pairs == 0 ? "none" : fmt::format("only {}", pairs), options.tolerance, options.min_pairs, ground_truth.size(),
      ground_truth.start(), ground_truth.end(), estimate.size(), start, end, hint(ground_truth, estimate, options)));
}

}  // namespace

Association associate(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate,
                      const AssociationOptions& options) {
  check(ground_truth, "ground truth");
  check(estimate, "estimate");
  const PoseTrajectory truth = ground_truth.cut(options.range.from, options.range.to);
  if (truth.empty()) {
    throw InputError(fmt::format("no ground truth in the time range {} to {} s; it spans {:.6f} to {:.6f} s",
                                 options.range.from, options.range.to, ground_truth.start(), ground_truth.end()));
  }
  if (estimate.size() < options.min_pairs) {
    throw InputError(fmt::format("the estimate has {} pose{}, expected at least {}", estimate.size(),
                                 estimate.size() == 1 ? "" : "s", options.min_pairs));
  }
  Association result;
  result.pairs = options.mode == AssociationMode::nearest ? nearest_pairs(truth, estimate, options)
                                                          : interpolated_pairs(truth, estimate, options);
  if (result.pairs.size() < options.min_pairs) fail_too_few(truth, estimate, result.pairs.size(), options);
  std::size_t used = 0;
  double last = -std::numeric_limits<double>::infinity();  // pairs of the same pose are consecutive
  for (const PosePair& pair : result.pairs) used += std::exchange(last, pair.t) != pair.t ? 1 : 0;
  result.unmatched = estimate.size() - used;
  std::vector<double> truth_times, pair_times;
  for (const StampedPose& pose : truth.poses()) truth_times.push_back(pose.t);
  for (const PosePair& pair : result.pairs) pair_times.push_back(pair.t);
  result.coverage = coverage(truth_times, pair_times);
  return result;
}

}  // namespace evbench
