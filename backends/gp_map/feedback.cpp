#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "backends/gp_map/gp_map.hpp"
#include "core/geometry/in_view.hpp"
#include "core/geometry/seen_point.hpp"
#include "core/motion/wnoa.hpp"
#include "core/support/index.hpp"

// Feedback for the front-end: the state of the tracking, and where landmarks are expected in the image. An initial map
// that is not confirmed is used for it, too, because its tracks continue in any case.
namespace evbench::gp_map {

Feedback GpMap::feedback(const FeedbackNeeds& needs) {
  Feedback feedback;
  feedback.t = until_;
  if (std::exchange(reinitialised_, false)) return feedback;  // no map, even if there is a new one already
  feedback.state = monitor_.state();
  if (!map_) return feedback;
  feedback.outliers = std::exchange(map_->outliers, {});
  if (monitor_.lost()) return feedback;
  feedback.newest = newest_seen();
  if (needs.covariance) feedback.covariance = covariance(feedback.newest->t);
  if (needs.expected) feedback.expected = expected_features();
  return feedback;
}

/// The newest state or, if it is ahead of the data (per-observation mode), the estimate at their end.
ControlState GpMap::newest_seen() const {
  const ControlState& newest = graph().states.back();
  if (newest.t <= until_) return newest;
  return {until_, *pose(until_), *velocity(until_)};
}

/// All landmarks in view, predicted with constant velocity. One whose track has ended counts as independent of the
/// newest state.
std::vector<ExpectedFeature> GpMap::expected_features() {
  constexpr double kNear = 1e-3;  // [units] before the camera: nearer points have no image
  // Computed while it is near the newest state: later this takes a long walk back.
  for (const TrackId id : std::exchange(map_->ended_landmarks, {})) {
    const auto track = tracks_.find(id);
    if (track != tracks_.end() && track->second.role == Track::Role::landmark) covariance_of_ended(track->second);
  }
  const PinholeCamera& camera = context_.camera;
  const ControlState& newest = graph().states.back();
  const double dt = until_ - newest.t;
  const SE3 motion = se3::exp(dt * newest.velocity), T_camera_world = (newest.T * motion).inverse();
  Eigen::Matrix<double, 6, 12> J_pose;  // of the predicted pose's increment
  J_pose << se3::adjoint(motion.inverse()), dt * se3::right_jacobian(dt * newest.velocity);
  const Matrix6 drift = wnoa::process_covariance(std::abs(dt), graph().qc).topLeftCorner<6, 6>();
  std::vector<ExpectedFeature> result;
  for (const TrackId id : nearly_in_view()) {
    Track& track = tracks_.at(id);
    if (track.ended && !covariance_of_ended(track)) continue;
    const Vector3 position = graph().landmarks[index(track.landmark)].position;
    const Vector3 point = T_camera_world * position;
    if (point.z() < kNear) continue;
    const Vector2 pixel = camera.project(point);
    if (!in_view(camera, pixel, kLensReach)) continue;
    const Matrix23 J_point = camera.project_jacobian(point), J_landmark = J_point * T_camera_world.R();
    const Matrix26 J_image = J_point * seen_point_jacobian(point);
    const auto& known = image_covariance(track, J_image * J_pose, J_landmark);
    if (known) result.push_back({id, position, pixel, *known + J_image * drift * J_image.transpose()});
  }
  return result;
}

/// Tracks whose landmarks are in view or may come into view before the next state. Computed once a step: a long
/// recording has many more landmarks.
const std::vector<TrackId>& GpMap::nearly_in_view() {
  constexpr double kMargin = 0.2;  // [rad] beyond the rotation by the newest velocity
  constexpr double kClose = 5.0;   // times the camera's displacement: nearer points may come in from any side
  if (map_->nearly_in_view) return *map_->nearly_in_view;
  std::vector<TrackId>& tracks = map_->nearly_in_view.emplace();
  const PinholeCamera& camera = context_.camera;
  const ControlState& newest = graph().states.back();
  const double longest = std::max(placement_.upcoming() - newest.t, std::abs(until_ - newest.t));
  const Vector6 increment = 2.0 * longest * newest.velocity;
  const double corner = std::atan(kLensReach * std::hypot(camera.cx / camera.fx, camera.cy / camera.fy));
  const double least = std::cos(std::min(corner + increment.head<3>().norm() + kMargin, std::numbers::pi));
  const double close = kClose * increment.tail<3>().norm();
  const Vector3 axis = newest.T.R().col(2);
  for (std::size_t j = 0; j < map_->known.size(); ++j) {
    const FactorGraph::Landmark& landmark = graph().landmarks[j];
    const Vector3 ray = landmark.position - newest.T.p;
    const double distance = ray.norm();
    if (!landmark.alive || (distance > close && axis.dot(ray) < least * distance)) continue;
    const auto track = tracks_.find(map_->known[j].track);
    if (track == tracks_.end() || track->second.role != Track::Role::landmark) continue;
    if (index(track->second.landmark) == j) tracks.push_back(track->first);
  }
  std::ranges::sort(tracks);
  return tracks;
}

/// Covariance of a landmark's image, without the motion since the newest state. Computed once a step: it is expensive,
/// and hardly changes before the next.
const std::optional<Matrix2>& GpMap::image_covariance(Track& track, const Eigen::Matrix<double, 2, 12>& J_state,
                                                      const Matrix23& J_landmark) {
  if (track.expected_at == map_->steps) return track.image_covariance;
  track.expected_at = map_->steps;
  track.image_covariance.reset();
  if (!track.ended) {
    track.covariance.reset();
    track.image_covariance = map_->engine.predicted_covariance(track.landmark, J_state, J_landmark);
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
  if (map_->newest_covariance.first != map_->steps) {
    map_->newest_covariance = {map_->steps, map_->engine.covariance(graph().states.back().t)};
  }
  return map_->newest_covariance.second;
}

/// The covariance at the end of the track; it changes little afterwards.
std::optional<Matrix3> GpMap::covariance_of_ended(Track& track) {
  if (!track.covariance) track.covariance = map_->engine.landmark_covariance(track.landmark);
  return track.covariance;
}

}  // namespace evbench::gp_map
