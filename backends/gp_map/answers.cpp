#include <algorithm>
#include <cmath>
#include <ranges>
#include <utility>

#include "backends/gp_map/gp_map.hpp"
#include "backends/gp_map/problem_graph.hpp"
#include "core/geometry/seen_point.hpp"
#include "core/motion/wnoa.hpp"

// What the back-end tells of its estimate: poses as they are made, feedback, and answers afterwards. While the first
// map is in doubt, until another explanation has been looked for in vain on both planes, no pose and no covariance is
// told.
namespace evbench::gp_map {

void GpMap::tell_online(double t) {
  const std::optional<SE3> T = pose(t);  // none where the state has been taken back
  if (!T || t <= online_ || is_in_doubt()) return;
  context_.online({{t, *T}, t, velocity(t)});
  online_ = t;
}

/// The newest state, and those of late anew: what is seen now tells of them, too.
void GpMap::tell_recent(double t) {
  if (graph().states.back().t != t) return;  // it has been taken back
  recent_->follow(graph(), engine_->first_state());
  if (is_in_doubt()) return;
  const auto states = recent_->states();
  if (options_.per_observation) {
    tell_online(t);  // as between the states
  } else {
    context_.online({{t, states.back().T}, t, states.back().velocity});
    online_ = t;
  }
  for (const ControlState& state : std::views::reverse(states.first(states.size() - 1))) {
    context_.online({{state.t, state.T}, t, state.velocity});
  }
}

Feedback GpMap::feedback(const FeedbackNeeds& needs) {
  Feedback feedback{until_, monitor_.state(), {}, {}, std::exchange(new_outliers_, {}), {}};
  if (!engine_ || monitor_.lost()) return feedback;
  feedback.newest = newest_seen();
  if (needs.covariance) feedback.covariance = covariance(feedback.newest->t);
  if (needs.expected) feedback.expected = expected_features();
  return feedback;
}

/// The newest state, or, where that stands ahead of the data (per-observation mode), the estimate at their end.
ControlState GpMap::newest_seen() const {
  const ControlState& newest = graph().states.back();
  if (newest.t <= until_) return newest;
  return {until_, *pose(until_), *velocity(until_)};
}

/// All landmarks in view, predicted with constant velocity. One whose track has ended counts as independent of the
/// newest state.
std::vector<ExpectedFeature> GpMap::expected_features() {
  constexpr double kNear = 1e-3;  // [units] before the camera: nearer has no image
  constexpr double kView = 1.5;   // of the principal point's distance from the border: lenses see farther than pinholes
  const PinholeCamera& camera = context_.camera;
  const ControlState& newest = graph().states.back();
  const double dt = until_ - newest.t;
  const SE3 motion = se3::exp(dt * newest.velocity), T_camera_world = (newest.T * motion).inverse();
  Eigen::Matrix<double, 6, 12> J_pose;  // of the predicted pose's increment
  J_pose << se3::adjoint(motion.inverse()), dt * se3::right_jacobian(dt * newest.velocity);
  const Matrix6 drift = wnoa::process_covariance(std::abs(dt), graph().qc).topLeftCorner<6, 6>();
  std::vector<ExpectedFeature> result;
  for (auto& [id, track] : tracks_) {
    if (track.role != Track::Role::landmark) continue;
    if (track.ended && !covariance_of_ended(track)) continue;  // soon: later it takes a long walk back
    const Vector3 position = graph().landmarks[index(track.landmark)].position;
    const Vector3 point = T_camera_world * position;
    if (point.z() < kNear) continue;
    const Vector2 pixel = camera.project(point);
    if (std::abs(pixel.x() - camera.cx) > kView * camera.cx || std::abs(pixel.y() - camera.cy) > kView * camera.cy)
      continue;
    const Matrix23 J_point = camera.project_jacobian(point), J_landmark = J_point * T_camera_world.R();
    const Matrix26 J_image = J_point * seen_point_jacobian(point);
    const auto& known = image_covariance(track, J_image * J_pose, J_landmark);
    if (known) result.push_back({id, position, pixel, *known + J_image * drift * J_image.transpose()});
  }
  return result;
}

/// How well a landmark's image is known but for the motion since the newest state. Found once a state: it is dear, and
/// hardly changes before the next.
const std::optional<Matrix2>& GpMap::image_covariance(Track& track, const Eigen::Matrix<double, 2, 12>& J_state,
                                                      const Matrix23& J_landmark) {
  if (track.expected_at == graph().states.size()) return track.image_covariance;
  track.expected_at = graph().states.size();
  track.image_covariance.reset();
  if (!track.ended) {
    track.covariance.reset();
    track.image_covariance = engine_->predicted_covariance(track.landmark, J_state, J_landmark);
  } else {
    const std::optional<Matrix12>& state = newest_covariance();
    const std::optional<Matrix3> own = covariance_of_ended(track);
    if (state && own) {
      track.image_covariance = J_state * *state * J_state.transpose() + J_landmark * *own * J_landmark.transpose();
    }
  }
  return track.image_covariance;
}

const std::optional<Matrix12>& GpMap::newest_covariance() {
  if (newest_covariance_.first != graph().states.size()) {
    newest_covariance_ = {graph().states.size(), engine_->covariance(graph().states.back().t)};
  }
  return newest_covariance_.second;
}

/// As it was when the track had ended: what is learnt of it afterwards is little, and finding it takes a walk back.
std::optional<Matrix3> GpMap::covariance_of_ended(Track& track) {
  if (!track.covariance) track.covariance = engine_->landmark_covariance(track.landmark);
  return track.covariance;
}

PoseTrajectory GpMap::trajectory() const {
  std::vector<StampedPose> poses;
  if (!engine_) return {};
  for (const ControlState& state : graph().states) poses.push_back({state.t, state.T});
  return PoseTrajectory(std::move(poses));
}

std::optional<SE3> GpMap::pose(double t) const {
  const int k = engine_ ? graph().interval_of(t) : -1;
  if (k < 0) return std::nullopt;
  return GpInterval(graph().states[index(k - 1)], graph().states[index(k)]).pose(t);
}

std::optional<Vector6> GpMap::velocity(double t) const {
  const int k = engine_ ? graph().interval_of(t) : -1;
  if (k < 0) return std::nullopt;
  return GpInterval(graph().states[index(k - 1)], graph().states[index(k)]).velocity(t);
}

/// None while the map is in doubt: it may be wrong altogether, of which its covariance would tell nothing.
std::optional<Matrix12> GpMap::covariance(double t) {
  if (!engine_ || is_in_doubt()) return std::nullopt;
  auto result = engine_->covariance(t);
  if (result) *result *= information_told_;
  return result;
}

std::optional<Matrix6> GpMap::relative_covariance(double t0, double t1) {
  if (!engine_) return std::nullopt;
  const auto state_at = [&](double t) {
    const auto found = std::ranges::lower_bound(graph().states, t, {}, &ControlState::t);
    return static_cast<int>(found - graph().states.begin());
  };
  const int i = state_at(t0), j = state_at(t1);
  const std::optional<Matrix12> joint = engine_->poses(i, j);
  if (!joint) return std::nullopt;
  const SE3 inverse = graph().states[index(j)].T.inverse() * graph().states[index(i)].T;
  Eigen::Matrix<double, 6, 12> J;  // (T_i Exp δ_i)⁻¹ T_j Exp δ_j = T_i⁻¹ T_j Exp(δ_j − Ad(T_j⁻¹ T_i) δ_i)
  J << -se3::adjoint(inverse), Matrix6::Identity();
  return Matrix6(information_told_ * J * *joint * J.transpose());
}

std::vector<Landmark> GpMap::map() const {
  std::vector<Landmark> result;
  for (const auto& [id, track] : tracks_) {
    if (track.role != Track::Role::landmark && track.role != Track::Role::slid) continue;
    result.push_back({id, graph().landmarks[index(track.landmark)].position});
  }
  return result;
}

std::vector<std::string> GpMap::learnt() const {
  return {"noise_scale",   "noise_share",      "qc_rotation_x",    "qc_rotation_y",
          "qc_rotation_z", "qc_translation_x", "qc_translation_y", "qc_translation_z"};
}

std::optional<Problem> GpMap::problem() const {
  if (!engine_ || options_.lag > 0.0) return std::nullopt;
  return to_problem(graph());
}

}  // namespace evbench::gp_map
