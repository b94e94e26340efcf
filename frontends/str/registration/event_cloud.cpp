#include "frontends/str/registration/event_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/support/index.hpp"

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

void make_cloud(std::span<const Event> events, const RayTable& rays, std::int64_t reference, EventCloud& cloud) {
  cloud.clear();
  for (const Event& event : events) {
    const Eigen::Vector2f& ray = rays.ray(event.x, event.y);
    if (!std::isfinite(ray.x())) continue;
    cloud.add(ray.x(), ray.y(), 1e-6F * static_cast<float>(event.t - reference), event.on);
  }
}

std::vector<Event> take_evenly(std::span<const Event> events, std::size_t count) {
  count = std::min(count, events.size());
  std::vector<Event> result(count);
  for (std::size_t k = 0; k < count; ++k) result[k] = events[k * events.size() / count];
  return result;
}

EventCloud take_evenly(const EventCloud& cloud, std::size_t count) {
  count = std::min(count, cloud.size());
  EventCloud result;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = k * cloud.size() / count;
    result.add(cloud.x[i], cloud.y[i], cloud.t[i], cloud.on[i] != 0);
  }
  return result;
}

void sort_by_place(std::vector<Event>& events, int width, int height) {
  constexpr int kSide = 8;  // [px]
  const int columns = width / kSide + 1, rows = height / kSide + 1;
  const auto square = [&](const Event& event) { return index(event.y / kSide * columns + event.x / kSide); };
  std::vector<std::size_t> place(index(columns * rows) + 1);  // of the next event in a square
  for (const Event& event : events) ++place[square(event) + 1];
  std::partial_sum(place.begin(), place.end(), place.begin());
  std::vector<Event> sorted(events.size());
  for (const Event& event : events) sorted[place[square(event)]++] = event;
  events = std::move(sorted);
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
