#include "core/motion/pose_spline.hpp"

#include <algorithm>

namespace evbench {

PoseSpline::PoseSpline(const PoseTrajectory& trajectory) {
  const std::vector<StampedPose>& poses = trajectory.poses();
  for (std::size_t i = 1; i + 1 < poses.size(); ++i) arcs_.push_back(arc(poses[i - 1], poses[i], poses[i + 1]));
  if (arcs_.empty()) arcs_.push_back(line(poses.front(), poses.back()));
}

PoseSpline::Arc PoseSpline::arc(const StampedPose& before, const StampedPose& centre, const StampedPose& after) {
  const SE3 inverse = centre.T.inverse();
  const double back = centre.t - before.t, ahead = after.t - centre.t;
  const Vector6 slope_back = -se3::log(inverse * before.T) / back, slope_ahead = se3::log(inverse * after.T) / ahead;
  return {centre.t, centre.T, (back * slope_ahead + ahead * slope_back) / (back + ahead),
          (slope_ahead - slope_back) / (back + ahead)};
}

PoseSpline::Arc PoseSpline::line(const StampedPose& from, const StampedPose& to) {
  if (!(from.t < to.t)) return {from.t, from.T, Vector6::Zero(), Vector6::Zero()};
  return {from.t, from.T, se3::log(from.T.inverse() * to.T) / (to.t - from.t), Vector6::Zero()};
}

SE3 PoseSpline::Arc::at(double time) const {
  const double tau = time - t;
  return T * se3::exp(tau * v + tau * tau * a);
}

SE3 PoseSpline::at(double t) const {
  const auto right = std::ranges::upper_bound(arcs_, t, {}, &Arc::t);
  if (right == arcs_.begin()) return right->at(t);
  if (right == arcs_.end()) return arcs_.back().at(t);
  const Arc& left = *(right - 1);
  const double s = (t - left.t) / (right->t - left.t);
  const double w = s * s * s * (10.0 + s * (6.0 * s - 15.0));
  const SE3 L = left.at(t);
  return L * se3::exp(w * se3::log(L.inverse() * right->at(t)));
}

}  // namespace evbench
