#include "frontends/str/registration/event_cloud.hpp"

#include <cmath>
#include <limits>

namespace evbench::str {

RayTable::RayTable(const Camera& camera)
    : width_(camera.width),
      height_(camera.height),
      focal_length_(0.5 * (camera.pinhole.fx + camera.pinhole.fy)),
      rays_(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height)) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const auto pixel = camera.undistort(Vector2(x, y));
      rays_[static_cast<std::size_t>(y * width_ + x)] =
          pixel ? Eigen::Vector2f(camera.pinhole.ray(*pixel).head<2>().cast<float>()) : Eigen::Vector2f(kNone, kNone);
    }
  }
}

void EventCloud::clear() {
  x.clear();
  y.clear();
  t.clear();
  on.clear();
}

void EventCloud::add(float ray_x, float ray_y, float time, bool polarity) {
  x.push_back(ray_x);
  y.push_back(ray_y);
  t.push_back(time);
  on.push_back(polarity ? 1 : 0);
}

void make_cloud(std::span<const Event> events, const RayTable& rays, std::int64_t reference, std::size_t most,
                EventCloud& cloud) {
  cloud.clear();
  const std::size_t count = most == 0 ? events.size() : std::min(most, events.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Event& event = events[i * events.size() / count];
    const Eigen::Vector2f& ray = rays.ray(event.x, event.y);
    if (!std::isfinite(ray.x())) continue;
    cloud.add(ray.x(), ray.y(), 1e-6F * static_cast<float>(event.t - reference), event.on);
  }
}

void warp(const EventCloud& cloud, const Matrix3& A, std::vector<float>& x, std::vector<float>& y) {
  const Eigen::Matrix3f a = A.cast<float>();
  const float a00 = a(0, 0), a01 = a(0, 1), a02 = a(0, 2), a10 = a(1, 0), a11 = a(1, 1), a12 = a(1, 2), a20 = a(2, 0),
              a21 = a(2, 1), a22 = a(2, 2);
  const std::size_t count = cloud.size();
  x.resize(count);
  y.resize(count);
  const float *in_x = cloud.x.data(), *in_y = cloud.y.data(), *in_t = cloud.t.data();
  float *out_x = x.data(), *out_y = y.data();
  for (std::size_t i = 0; i < count; ++i) {
    float u = in_x[i], v = in_y[i], w = 1.0F;
    for (int power = 4; power > 0; --power) {  // Horner's scheme
      const float s = in_t[i] / static_cast<float>(power);
      const float next_u = in_x[i] + s * (a00 * u + a01 * v + a02 * w);
      const float next_v = in_y[i] + s * (a10 * u + a11 * v + a12 * w);
      const float next_w = 1.0F + s * (a20 * u + a21 * v + a22 * w);
      u = next_u;
      v = next_v;
      w = next_w;
    }
    out_x[i] = u / w;
    out_y[i] = v / w;
  }
}

}  // namespace evbench::str
