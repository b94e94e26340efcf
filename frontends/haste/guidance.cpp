#include "frontends/haste/guidance.hpp"

#include <cmath>
#include <vector>

#include "core/geometry/seen_point.hpp"
#include "core/geometry/solve_symmetric.hpp"

namespace evbench::haste {

void Guidance::receive(const Feedback& feedback) {
  reliable_ = feedback.state == TrackingState::tracking || feedback.state == TrackingState::stationary;
  world_ = feedback.world;
  const bool usable = reliable_ || (degraded_ && feedback.state == TrackingState::degraded);
  correction_ = {};
  newest_ = usable ? feedback.newest : std::nullopt;
  expected_.clear();
  if (!newest_) return;
  for (const ExpectedFeature& feature : feedback.expected) expected_.emplace(feature.track, feature);
}

std::optional<Vector3> Guidance::position(TrackId track) const {
  const auto found = expected_.find(track);
  if (found == expected_.end()) return std::nullopt;
  return found->second.position;
}

void Guidance::correct(std::span<const Sighting> sightings) {
  constexpr std::size_t kEnough = 8;
  constexpr int kIterations = 4;
  constexpr double kWidth = 1.0;  // [px] where the Cauchy loss turns from quadratic
  constexpr double kHold = 1e-3;  // damping, for directions that the landmarks do not determine
  correction_ = {};
  if (!newest_) return;
  struct Seen {
    SE3 T;  ///< predicted
    Vector3 position;
    Vector2 pixel;  ///< undistorted
  };
  std::vector<Seen> seen;
  for (const Sighting& sighting : sightings) {
    const std::optional<Vector3> point = position(sighting.track);
    const std::optional<Vector2> pixel = camera_.undistort(sighting.pixel);
    if (point && pixel) seen.push_back({pose(sighting.t), *point, *pixel});
  }
  if (seen.size() < kEnough) return;
  for (int i = 0; i < kIterations; ++i) {
    Matrix6 H = kHold * Matrix6::Identity();
    Vector6 b = Vector6::Zero();
    for (const Seen& z : seen) {
      const Vector3 q = (z.T * correction_).inverse() * z.position;
      if (!(q.z() > 0.0)) continue;
      const Vector2 e = camera_.pinhole.project(q) - z.pixel;
      const Matrix26 J = camera_.pinhole.project_jacobian(q) * seen_point_jacobian(q);
      const double weight = 1.0 / (1.0 + e.squaredNorm() / (kWidth * kWidth));
      H += weight * J.transpose() * J;
      b -= weight * J.transpose() * e;
    }
    const Vector6 step = solve_symmetric(H, b);
    if (!step.allFinite()) {
      correction_ = {};
      return;
    }
    correction_ = correction_ * se3::exp(step);
  }
}

std::optional<Guidance::Prediction> Guidance::predict(TrackId track, double t) const {
  const auto found = expected_.find(track);
  if (!newest_ || found == expected_.end()) return std::nullopt;
  const Vector3 point = pose(t).inverse() * found->second.position;
  if (!(point.z() > 0.0)) return std::nullopt;
  const Vector2 pixel = camera_.project(point);
  if (!pixel.allFinite()) return std::nullopt;
  return Prediction{pixel, found->second.covariance};
}

AppearanceChange appearance_change(const SE3& T_world_before, const SE3& T_world_now, const Vector3& point) {
  const Vector3 before = T_world_before.inverse() * point;
  const SE3 T = T_world_now.inverse() * T_world_before;  // T_now_before
  const auto image = [](const Vector3& p) -> Vector2 { return p.head<2>() / p.z(); };
  // The image of a small step along x and along y of the earlier image, at the point's depth.
  constexpr double kStep = 1e-3;
  const Vector3 now = T * before;
  if (!(before.z() > 0.0) || !(now.z() > 0.0)) return {};
  const Vector3 step_x = T * (before + Vector3(kStep * before.z(), 0.0, 0.0));
  const Vector3 step_y = T * (before + Vector3(0.0, kStep * before.z(), 0.0));
  const Vector2 x = (image(step_x) - image(now)) / kStep, y = (image(step_y) - image(now)) / kStep;
  // The nearest similarity.
  const double c = 0.5 * (x.x() + y.y()), s = 0.5 * (x.y() - y.x());
  const double scale = std::hypot(c, s);
  if (!std::isfinite(scale) || scale == 0.0) return {};
  return {std::atan2(s, c), scale};
}

}  // namespace evbench::haste
