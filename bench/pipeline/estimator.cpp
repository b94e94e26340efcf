#include "bench/pipeline/estimator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/structure/map_alignment.hpp"

namespace evbench {
namespace {

/// The trajectory at that rate [Hz]; the back-end's own poses if the rate is 0 or so low that there would be none.
PoseTrajectory sample(const BackEnd& backend, double rate) {
  const PoseTrajectory own = backend.trajectory();
  if (rate == 0.0 || own.empty()) return own;
  std::vector<StampedPose> poses;
  const auto first = static_cast<std::int64_t>(std::ceil(own.start() * rate - 1e-9));
  for (std::int64_t k = first; static_cast<double>(k) / rate <= own.end(); ++k) {
    const double t = static_cast<double>(k) / rate;
    std::optional<SE3> T = backend.pose(t);
    if (!T) T = own.pose(t);
    if (T) poses.push_back({t, *T});
  }
  if (poses.empty()) return own;
  return PoseTrajectory(std::move(poses), "the back-end's trajectory");
}

/// The back-end's own velocities at the poses, if it has any.
std::vector<StampedVelocity> velocities_at(const BackEnd& backend, const PoseTrajectory& trajectory) {
  std::vector<StampedVelocity> result;
  for (const StampedPose& pose : trajectory.poses()) {
    const std::optional<Vector6> velocity = backend.velocity(pose.t);
    if (velocity && velocity->allFinite()) result.push_back({pose.t, *velocity});
  }
  return result;
}

bool is_finite(const StampedPose& pose) { return pose.T.p.allFinite() && pose.T.q.coeffs().allFinite(); }

/// Evenly distributed poses of the trajectory.
std::vector<SE3> views_of(const PoseTrajectory& trajectory) {
  constexpr std::size_t kViews = 24;
  std::vector<SE3> views;
  const std::size_t count = std::min(kViews, trajectory.size());
  for (std::size_t i = 0; i < count; ++i) {
    views.push_back(trajectory.poses()[i * (trajectory.size() - 1) / std::max<std::size_t>(count - 1, 1)].T);
  }
  return views;
}

}  // namespace

/// A pose that is ahead of the data counts as known at its own time. The back-end states known_at in times of the
/// observations that it used; the delay of the front-end is added to that.
void Estimator::on_pose(CausalPose pose, double until, double seen) {
  if (!std::isfinite(pose.t) || !is_finite(pose) || (pose.velocity && !pose.velocity->allFinite())) {
    throw std::runtime_error(fmt::format("the back-end's pose at {:.6f} s is not finite", pose.t));
  }
  const double now = std::max(pose.t, pose.known_at.value_or(seen));
  if (!published.empty() && !(now >= last_known_at)) {
    throw std::runtime_error(
        fmt::format("the back-end published a pose known at {:.6f} s after one known at {:.6f} s", now, last_known_at));
  }
  last_known_at = now;
  const double complete = pose.known_at.value_or(seen), delay = seen - until;
  pose.known_at = std::max(pose.t, complete < seen ? std::min(complete + delay, seen) : complete);
  // Poses are published in order: one with a smaller delay waits for those before it.
  if (!published.empty()) pose.known_at = std::max(*pose.known_at, *published.back().known_at);
  published.push_back(pose);
  if (!newest || pose.t >= newest->t) newest = pose;
  if (is_relocalised()) published_in_world.push_back(transformed(pose, to_world));
}

std::vector<Landmark> Estimator::confirmed_map() const {
  std::vector<Landmark> result = backend->map();
  std::erase_if(result, [&](const Landmark& landmark) { return unconfirmed.contains(landmark.track); });
  return result;
}

std::optional<Estimator::Relocalisation> Estimator::find_in(const Estimator& other, const PinholeCamera& camera) const {
  const std::vector<SE3> views = views_of(backend->trajectory());
  const auto alignment = align_maps(confirmed_map(), views, other.confirmed_map(), camera);
  if (!alignment) return std::nullopt;
  return Relocalisation{other.world, other.to_world * alignment->transform.inverse(), alignment->landmarks};
}

void Estimator::relocalise(const Relocalisation& found) {
  if (world != found.world) published_in_world.clear();
  world = found.world;
  to_world = found.to_world;
}

std::optional<TrajectorySegment> Estimator::segment(double rate) {
  TrajectorySegment result;
  result.final_trajectory = sample(*backend, rate);
  if (!std::ranges::all_of(result.final_trajectory.poses(), is_finite)) {
    throw std::runtime_error("the back-end's trajectory is not finite");
  }
  const Status its_status = status();
  if (its_status.state == RunState::lost && !result.final_trajectory.empty()) {
    result.final_trajectory = result.final_trajectory.cut(result.final_trajectory.start(), its_status.time);
  }
  if (result.final_trajectory.empty() || its_status.state == RunState::failed) return std::nullopt;
  result.velocities = velocities_at(*backend, result.final_trajectory);
  // Poses after the loss are not supported by data.
  if (its_status.state == RunState::lost) {
    const auto after_loss = [&](const CausalPose& pose) { return pose.t > its_status.time; };
    std::erase_if(published, after_loss);
  }
  result.published = std::move(published);
  result.causal_trajectory = newest_poses(result.published);
  result.map = confirmed_map();
  result.problem = backend->problem();
  result.relative = covariances.finish(*backend);
  if (its_status.state == RunState::lost) {
    std::erase_if(result.relative, [&](const RelativePose& relative) { return relative.t1 > its_status.time; });
  }
  result.covered = result.final_trajectory.end() - result.final_trajectory.start();
  return result;
}

}  // namespace evbench
