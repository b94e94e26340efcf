#include "spline.hpp"

#include <algorithm>
#include <cmath>

namespace spline_map {

void Spline::extend_to(double t) {
  while (end() < t) {
    const Knot &before = knots_[knots_.size() - 2], &last = knots_.back();
    const Eigen::Quaterniond step = before.rotation().conjugate() * last.rotation();
    knots_.emplace_back((last.rotation() * step).normalized(), 2.0 * last.position() - before.position());
  }
}

void Spline::cut(double t) {
  while (segments() > 1 && end() - spacing_ >= t) knots_.pop_back();
}

Spline::Place Spline::place(double t) const {
  const double x = (t - start_) / spacing_;
  const double s = std::clamp(std::floor(x), 0.0, static_cast<double>(segments() - 1));
  return {static_cast<std::size_t>(s), x - s};
}

SE3 Spline::pose(double t) const {
  const Place at = place(t);
  return segment(at.segment).pose(at.u);
}

evbench::ControlState Spline::state(double t) const {
  const Place at = place(t);
  const SplineSegment here = segment(at.segment);
  return {t, here.pose(at.u), here.velocity(at.u) / spacing_};
}

}  // namespace spline_map
