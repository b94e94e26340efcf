#include "core/smoother/engine/landmark_views.hpp"

#include "core/smoother/engine/lane_loss.hpp"

namespace evbench::smoother {

using namespace lanes;  // NOLINT: this file works by lanes

LandmarkViews::LandmarkViews(const FactorGraph& graph, int landmark)
    : graph_(graph), prior_(graph.landmarks[index(landmark)].prior) {
  for (const int k : graph.landmarks[index(landmark)].intervals) {
    const GpInterval interval = graph.interval(k);
    const Matrix3 R = interval.T0().R().transpose();
    const Vector3 p = -(R * interval.T0().p);
    with_kind_of(interval, [&]<int orders, Range range>() {
      const Interval<orders> shared(interval);
      for (auto rest = graph.intervals[index(k)].of(landmark); !rest.empty();) {
        const std::size_t count = std::min<std::size_t>(kLanes, rest.size());
        Measured observed(shared.t0);
        for (std::size_t i = 0; i < count; ++i) observed.set(i, rest[i]);
        rest = rest.subspan(count);
        views_.push_back({R, p, motion(tangent<range, orders>(shared, basis_at(shared, observed.t))), observed});
      }
    });
  }
}

Residual LandmarkViews::residual_at(const View& view, const Vector3& position) const {
  const Lane3 m = lane3(view.R * position + view.p);
  return residual_of(graph_.camera, view.motion.into_camera(m), view.observed);
}

double LandmarkViews::cost(const Vector3& position) const {
  Lane cost{};
  for (const View& view : views_) {
    cost += view.observed.present * loss_of(graph_.loss, residual_at(view, position).square).value;
  }
  return 0.5 * (sum(cost) + residual(prior_, position).squaredNorm());
}

LandmarkViews::System LandmarkViews::linearise(const Vector3& position) const {
  System system;
  if (std::isfinite(prior_.sigma)) {
    system.H.diagonal().setConstant(1.0 / (prior_.sigma * prior_.sigma));
    system.g = (position - prior_.position) / (prior_.sigma * prior_.sigma);
  }
  for (const View& view : views_) {
    const Residual r = residual_at(view, position);
    const Lane weight = r.in_front ? view.observed.present * loss_of(graph_.loss, r.square).weight : Lane{};
    const ImageRows D = image_rows(graph_.camera, r, view.observed);
    const Lane3 dx = view.motion.turn_back(D.x), dy = view.motion.turn_back(D.y);
    const std::array<Lane, 3> x = {dx.x, dx.y, dx.z}, y = {dy.x, dy.y, dy.z};
    Matrix3 H;  // with respect to m
    Vector3 g;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      g(row) = sum(weight * (x[i] * r.e0 + y[i] * r.e1));
      for (std::size_t j = 0; j <= i; ++j) {
        const auto column = static_cast<Eigen::Index>(j);
        H(row, column) = H(column, row) = sum(weight * (x[i] * x[j] + y[i] * y[j]));
      }
    }
    system.H += view.R.transpose() * H * view.R;
    system.g += view.R.transpose() * g;
  }
  return system;
}

}  // namespace evbench::smoother
