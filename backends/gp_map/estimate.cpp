#include "backends/gp_map/estimate.hpp"

#include <set>

#include "core/smoother/factors.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {

std::optional<SE3> Estimate::pose(double t) const {
  const int k = graph().interval_of(t);
  if (k < 0) return std::nullopt;
  return graph().interval(k).pose(t);
}

std::optional<Vector6> Estimate::velocity(double t) const {
  const int k = graph().interval_of(t);
  if (k < 0) return std::nullopt;
  return graph().interval(k).velocity(t);
}

double Estimate::median_depth() const {
  constexpr std::size_t kEnough = 10;
  const SE3 T_camera_world = newest().T.inverse();
  std::vector<double> depths;
  for (std::size_t k = graph().intervals.size(); k-- > 0 && depths.size() < kEnough;) {
    for (const auto& group : graph().intervals[k].groups()) {
      const double z = (T_camera_world * graph().landmarks[index(group.landmark)].position).z();
      if (z > 0.0) depths.push_back(z);
    }
  }
  return depths.empty() ? 1.0 : median(depths);
}

void Estimate::end_step() {
  const std::size_t n = graph().states.size();
  const double share = static_cast<double>(graph().intervals.back().groups().size()) / enough_;
  moved_ += std::min(share, 1.0) * (graph().states[n - 1].t - graph().states[n - 2].t);
  ++steps_;
}

void Estimate::update() {
  last_update = smoother.update();
  count(Count::updates);
  if (last_update.damping > 0.0) count(Count::updates_damped);
  count(Count::stages, last_update.stages);
}

int Estimate::add_landmark(const Vector3& guess, const LandmarkPrior& prior) {
  factors_.emplace_back();
  return smoother.add_landmark(guess, prior);
}

void Estimate::remove_landmark(int landmark) {
  std::set<int> anchors(graph().anchor.landmarks.begin(), graph().anchor.landmarks.end());
  if (anchors.erase(landmark) > 0 && std::ssize(anchors) < enough_) {
    for (const auto& group : graph().intervals.back().groups()) {
      if (group.landmark != landmark) anchors.insert(group.landmark);
    }
    smoother.anchor_scale(graph().anchor.origin, {anchors.begin(), anchors.end()});
    count(Count::scale_anchored_anew);
  }
  smoother.remove_landmark(landmark);
}

void Estimate::set_track_noise(int landmark, double factor) {
  factors_[index(landmark)].noise = factor;
  scale_sigmas(landmark);
}

void Estimate::set_leverage(int landmark, double factor) {
  factors_[index(landmark)].leverage = factor;
  scale_sigmas(landmark);
}

void Estimate::scale_sigmas(int landmark) {
  const Factors& factors = factors_[index(landmark)];
  const double scale = std::max(factors.noise, factors.leverage);
  if (scale != graph().landmarks[index(landmark)].sigma_scale) smoother.scale_sigmas(landmark, scale);
}

std::optional<Matrix3> Estimate::kept_covariance(int landmark) {
  std::optional<Matrix3>& kept = covariances_[landmark];
  if (!kept) kept = smoother.landmark_covariance(landmark);
  return kept;
}

const std::optional<Matrix12>& Estimate::newest_covariance() {
  if (newest_covariance_.first != steps_) newest_covariance_ = {steps_, smoother.covariance(now())};
  return newest_covariance_.second;
}

}  // namespace evbench::gp_map
