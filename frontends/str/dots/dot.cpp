#include "frontends/str/dots/dot.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/solve_symmetric.hpp"

namespace evbench::str {

void DotOptions::declare(OptionSet& set) {
  set.add("window", window, "newest events of a dot that its position is estimated from").range(20, 100'000);
  set.add("longest_window", longest_window, "which are not older than this [s]").above(0.0);
  set.add("every", every, "events of a dot from one observation of it to the next; 1: each event is one")
      .range(1, 100'000);
  set.add("gate", gate, "an event is a dot's when it is this near to its rim [px]").above(0.0);
  set.add("event_noise", event_noise, "by how much events lie off the rim, standard deviation [px]").above(0.0);
  set.add("acceleration", acceleration, "of a dot in the image, standard deviation [px/s²]").above(0.0);
  set.add("radius_change", radius_change, "of a dot's radius from one observation to the next, standard deviation [px]")
      .above(0.0);
}

Dot::Dot(const DotOptions& options, const Circle& circle, const Vector2& velocity, double t)
    : options_(options), circle_(circle), velocity_(velocity), t_(t), newest_(t) {}

Vector2 Dot::centre(double t) const {
  const double speed = velocity_.norm();
  const double latest = speed > 0.0 ? std::min(t, newest_ + 1.0 / speed) : t;
  return circle_.centre + std::max(latest - t_, 0.0) * velocity_;
}

double Dot::rim_distance(const Vector2& pixel, double t) const {
  return std::abs((pixel - centre(t)).norm() - circle_.radius);
}

bool Dot::add(const Vector2& pixel, double t) {
  constexpr double kStopped = 2.0;  // [px] predicted motion without an event
  if (velocity_.norm() * (t - newest_) > kStopped) {
    circle_.centre = centre(t);
    velocity_.setZero();
    t_ = t;
    window_.clear();
  }
  window_.push_back({pixel, t});
  if (window_.size() > static_cast<std::size_t>(options_.window)) window_.pop_front();
  newest_ = t;
  if (++since_ < options_.every) return false;
  since_ = 0;
  return true;
}

std::optional<Dot::Sighting> Dot::locate() {
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  constexpr std::size_t kLeast = 20;
  constexpr int kSteps = 2;
  constexpr double kOutlier = 2.0;  // standard deviations at which an event counts half
  while (!window_.empty() && window_.front().t < newest_ - options_.longest_window) window_.pop_front();
  if (window_.size() < kLeast) return std::nullopt;
  double middle = 0.0;
  for (const Seen& seen : window_) middle += seen.t;
  middle /= static_cast<double>(window_.size());

  // Unknowns: centre and radius at the middle, velocity. Velocity and radius have priors.
  Vector2 c = centre(middle), v = velocity_;
  double r = circle_.radius;
  const double step = std::max(middle - t_, 1e-4);
  const double of_velocity = 1.0 / std::pow(options_.acceleration * step, 2.0);
  const double of_radius = 1.0 / std::pow(options_.radius_change, 2.0);
  const double of_event = 1.0 / std::pow(options_.event_noise, 2.0);
  double residual = 0.0;
  for (int iteration = 0; iteration < kSteps; ++iteration) {
    Eigen::Matrix<double, 5, 5> H = Eigen::Matrix<double, 5, 5>::Zero();
    Vector5 g = Vector5::Zero();
    double squares = 0.0;
    for (const Seen& seen : window_) {
      const double dt = seen.t - middle;
      const Vector2 d = seen.pixel - c - dt * v;
      const double distance = d.norm();
      if (!(distance > 0.0)) continue;
      const Vector2 u = -d / distance;
      const double e = distance - r;
      const double scaled = e / (kOutlier * options_.event_noise);
      const double weight = of_event / (1.0 + scaled * scaled);
      Vector5 J;
      J << u, dt * u, -1.0;
      H += weight * J * J.transpose();
      g += weight * e * J;
      squares += e * e;
    }
    residual = std::sqrt(squares / static_cast<double>(window_.size()));
    H.diagonal().segment<2>(2).array() += of_velocity;
    g.segment<2>(2) += of_velocity * (v - velocity_);
    H(4, 4) += of_radius;
    g[4] += of_radius * (r - circle_.radius);
    H.diagonal().head<2>().array() += 1e-6;
    const Vector5 change = solve_symmetric(H, -g);
    if (!change.allFinite()) return std::nullopt;
    c += change.head<2>();
    v += change.segment<2>(2);
    r += change[4];
  }
  circle_ = {c, std::max(r, 0.5)};
  velocity_ = v;
  t_ = middle;
  const auto own = std::ranges::min_element(window_, {}, [&](const Seen& seen) { return std::abs(seen.t - middle); });
  return Sighting{own->t, c + (own->t - middle) * v, residual};
}

}  // namespace evbench::str
