#include "backends/gp_map/modules/feature_prediction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/in_view.hpp"
#include "core/geometry/seen_point.hpp"

namespace evbench::gp_map {

std::vector<UndistortedFeature> FeaturePrediction::expected(Estimate& estimate, TrackTable& tracks, double t,
                                                            double upcoming) {
  constexpr double kNear = 1e-3;  // [units] before the camera: nearer points have no image
  // Computed while it is near the newest state: later this takes a long walk back.
  for (const TrackId id : tracks.take_ended()) {
    const TrackTable::Track* const track = tracks.find(id);
    if (track != nullptr && track->role == TrackTable::Role::landmark) estimate.kept_covariance(track->landmark);
  }
  const FactorGraph& graph = estimate.graph();
  const PinholeCamera& camera = graph.camera;
  const ControlState& newest = estimate.newest();
  const double dt = t - newest.t;
  const Vector6 xi = expected_motion(newest, dt, graph.motion_prior);
  const SE3 motion = se3::exp(xi), T_camera_world = (newest.T * motion).inverse();
  Eigen::Matrix<double, 6, 12> J_pose;  // of the predicted pose's increment
  J_pose << se3::adjoint(motion.inverse()), dt * se3::right_jacobian(xi);
  const Matrix6 J_acceleration = motion_per_acceleration(dt, graph.motion_prior) * se3::right_jacobian(xi);
  const Matrix6 drift = (motion_variance(std::abs(dt), graph.motion_prior) * graph.qc).asDiagonal();
  std::vector<UndistortedFeature> result;
  for (const auto& [id, landmark] : nearly_in_view(estimate, tracks, t, upcoming)) {
    const bool ended = tracks.at(id).ended;
    if (ended && !estimate.kept_covariance(landmark)) continue;
    const Vector3 position = graph.landmarks[index(landmark)].position;
    const Vector3 point = T_camera_world * position;
    if (point.z() < kNear) continue;
    const Vector2 pixel = camera.project(point);
    if (!in_view(camera, pixel, kLensReach)) continue;
    const Matrix23 J_point = camera.project_jacobian(point), J_landmark = J_point * T_camera_world.R();
    const Matrix26 J_image = J_point * seen_point_jacobian(point);
    ImageJacobian J_state(2, graph.state_size());
    J_state.leftCols<12>() = J_image * J_pose;
    if (graph.motion_prior.has_acceleration()) J_state.rightCols<6>() = J_image * J_acceleration;
    const auto& known = image_covariance(estimate, landmark, ended, J_state, J_landmark);
    if (known) result.push_back({id, position, pixel, *known + J_image * drift * J_image.transpose()});
  }
  return result;
}

/// Tracks whose landmarks are in view or may come into view before the next state. Computed once a step: a long
/// recording has many more landmarks.
const std::vector<std::pair<TrackId, int>>& FeaturePrediction::nearly_in_view(const Estimate& estimate,
                                                                              const TrackTable& tracks, double t,
                                                                              double upcoming) {
  constexpr double kMargin = 0.2;  // [rad] beyond the rotation by the newest velocity
  constexpr double kClose = 5.0;   // times the camera's displacement: nearer points may come in from any side
  auto& [step, result] = nearly_in_view_;
  if (step == estimate.steps()) return result;
  step = estimate.steps();
  result.clear();
  const FactorGraph& graph = estimate.graph();
  const PinholeCamera& camera = graph.camera;
  const ControlState& newest = estimate.newest();
  const double longest = std::max(upcoming - newest.t, std::abs(t - newest.t));
  const Vector6 increment = 2.0 * longest * newest.velocity;
  const double corner = std::atan(kLensReach * std::hypot(camera.cx / camera.fx, camera.cy / camera.fy));
  const double least = std::cos(std::min(corner + increment.head<3>().norm() + kMargin, std::numbers::pi));
  const double close = kClose * increment.tail<3>().norm();
  const Vector3 axis = newest.T.R().col(2);
  for (int j = 0; j < std::ssize(graph.landmarks); ++j) {
    const FactorGraph::Landmark& landmark = graph.landmarks[index(j)];
    const Vector3 ray = landmark.position - newest.T.p;
    const double distance = ray.norm();
    if (!landmark.alive || (distance > close && axis.dot(ray) < least * distance)) continue;
    const auto id = tracks.track_of(j);
    if (id && tracks.find(*id)->role == TrackTable::Role::landmark) result.emplace_back(*id, j);
  }
  std::ranges::sort(result);
  return result;
}

/// Covariance of a landmark's image, without the motion since the newest state. Computed once a step: it is expensive,
/// and hardly changes before the next.
const std::optional<Matrix2>& FeaturePrediction::image_covariance(Estimate& estimate, int landmark, bool ended,
                                                                  const ImageJacobian& J_state,
                                                                  const Matrix23& J_landmark) {
  auto& [step, covariances] = covariances_;
  if (step != estimate.steps()) covariances.clear();
  step = estimate.steps();
  const auto [place, is_new] = covariances.try_emplace(landmark);
  std::optional<Matrix2>& result = place->second;
  if (!is_new) return result;
  if (!ended) {
    estimate.forget_covariance(landmark);
    result = estimate.smoother.predicted_covariance(landmark, J_state, J_landmark);
  } else {
    const std::optional<Matrix12>& state = estimate.newest_covariance();
    const std::optional<Matrix3> own = estimate.kept_covariance(landmark);
    const Eigen::Matrix<double, 2, 12> J = J_state.leftCols<12>();  // known without the acceleration
    if (state && own) result = J * *state * J.transpose() + J_landmark * *own * J_landmark.transpose();
  }
  return result;
}

}  // namespace evbench::gp_map
