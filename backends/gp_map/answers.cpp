#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "backends/gp_map/gp_map.hpp"
#include "backends/gp_map/problem_graph.hpp"

// What the back-end publishes and answers. While the initial map is not confirmed, no causal pose and no covariance is
// published: not before the search for an alternative estimate on both planes has failed and most tracks fit the map.
namespace evbench::gp_map {

void GpMap::publish_newest(double t) {
  const std::optional<SE3> T = pose(t);  // none if the state has been removed
  if (!T || t <= published_ || is_pending()) return;
  context_.publish({{t, *T}, t, velocity(t)});
  published_ = t;
}

/// Publishes the newest state, and the recent ones again: new observations improve them, too.
void GpMap::publish_recent(double t) {
  if (graph().states.back().t != t) return;  // it has been removed
  map_->recent.follow(graph(), map_->engine.first_state());
  if (is_pending()) return;
  const auto states = map_->recent.states();
  if (options_.per_observation) {
    publish_newest(t);  // as between the states
  } else {
    context_.publish({{t, states.back().T}, t, states.back().velocity});
    published_ = t;
  }
  for (std::size_t i = states.size() - 1; i-- > 0;) {
    context_.publish({{states[i].t, states[i].T}, t, states[i].velocity});
  }
}

PoseTrajectory GpMap::trajectory() const {
  std::vector<StampedPose> poses;
  if (!map_) return {};
  for (const ControlState& state : graph().states) poses.push_back({state.t, state.T});
  return PoseTrajectory(std::move(poses));
}

std::optional<SE3> GpMap::pose(double t) const {
  const int k = map_ ? graph().interval_of(t) : -1;
  if (k < 0) return std::nullopt;
  return GpInterval(graph().states[index(k - 1)], graph().states[index(k)]).pose(t);
}

std::optional<Vector6> GpMap::velocity(double t) const {
  const int k = map_ ? graph().interval_of(t) : -1;
  if (k < 0) return std::nullopt;
  return GpInterval(graph().states[index(k - 1)], graph().states[index(k)]).velocity(t);
}

/// None while the initial map is not confirmed: it may be wrong altogether, which its covariance would not show.
std::optional<Matrix12> GpMap::covariance(double t) {
  if (!map_ || is_pending()) return std::nullopt;
  auto result = map_->engine.covariance(t);
  if (result) *result *= information_share_;
  return result;
}

std::optional<Matrix6> GpMap::relative_covariance(double t0, double t1) {
  if (!map_) return std::nullopt;
  const auto state_at = [&](double t) {
    const auto found = std::ranges::lower_bound(graph().states, t, {}, &ControlState::t);
    return static_cast<int>(found - graph().states.begin());
  };
  const int i = state_at(t0), j = state_at(t1);
  const std::optional<Matrix12> joint = map_->engine.poses(i, j);
  if (!joint) return std::nullopt;
  const SE3 inverse = graph().states[index(j)].T.inverse() * graph().states[index(i)].T;
  Eigen::Matrix<double, 6, 12> J;  // (T_i Exp δ_i)⁻¹ T_j Exp δ_j = T_i⁻¹ T_j Exp(δ_j − Ad(T_j⁻¹ T_i) δ_i)
  J << -se3::adjoint(inverse), Matrix6::Identity();
  return Matrix6(information_share_ * J * *joint * J.transpose());
}

std::vector<Landmark> GpMap::map() const {
  std::vector<Landmark> result;
  for (const auto& [id, track] : tracks_) {
    if (track.role != Track::Role::landmark && track.role != Track::Role::drifted) continue;
    result.push_back({id, graph().landmarks[index(track.landmark)].position});
  }
  return result;
}

std::vector<std::string> GpMap::estimated_parameters() const {
  std::vector<std::string> names = {"noise_scale", "noise_share"};
  for (const char* when : {"", "final_"}) {
    for (const char* axis :
         {"rotation_x", "rotation_y", "rotation_z", "translation_x", "translation_y", "translation_z"}) {
      names.push_back(fmt::format("{}qc_{}", when, axis));
    }
  }
  return names;
}

std::optional<Problem> GpMap::problem() const {
  if (!map_ || options_.lag > 0.0) return std::nullopt;
  return to_problem(graph());
}

}  // namespace evbench::gp_map
