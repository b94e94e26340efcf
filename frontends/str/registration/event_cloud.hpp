#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/events/event.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/types.hpp"

namespace evbench::str {

/// The ray of each pixel of a sensor, computed once.
class RayTable {
 public:
  explicit RayTable(const Camera& camera);

  /// (x, y) of the ray (x, y, 1) through a pixel, undistorted; not finite where the lens model has no inverse.
  const Eigen::Vector2f& ray(int x, int y) const { return rays_[static_cast<std::size_t>(y * width_ + x)]; }

  double focal_length() const { return focal_length_; }  ///< [px], of the two axes their mean
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  int width_, height_;
  double focal_length_;
  std::vector<Eigen::Vector2f> rays_;
};

/// Events as points: their rays, times and polarities, an array each.
struct EventCloud {
  std::vector<float> x, y;       ///< of the rays (x, y, 1)
  std::vector<float> t;          ///< [s] since the batch's reference time
  std::vector<std::uint8_t> on;  ///< 0 or 1

  std::size_t size() const { return x.size(); }
  void clear();
  void add(float ray_x, float ray_y, float time, bool polarity);
};

/// Replaces `cloud` by `events`; those without a ray are left out. `reference`: the time [µs] from which times are
/// counted.
void make_cloud(std::span<const Event> events, const RayTable& rays, std::int64_t reference, EventCloud& cloud);

/// `count` of the events, evenly spaced; all where there are no more.
std::vector<Event> take_evenly(std::span<const Event> events, std::size_t count);
EventCloud take_evenly(const EventCloud& cloud, std::size_t count);

/// Sorts events by image squares of 8 px, in the given order within each. Searches for the neighbours of consecutive
/// events then use the same memory, which stays in the cache; in time order, on a large sensor, nearly all accesses
/// would go to main memory. `width`, `height` [px]: of the sensor.
void sort_by_place(std::vector<Event>& events, int width, int height);

/// The points of a cloud under a motion at the reference time: exp(t A) (x, y, 1), by its series up to the fourth
/// power, whose error is |t A|⁵ / 120: below a hundredth of a pixel for motions of a quarter of the view.
void warp(const EventCloud& cloud, const Matrix3& A, std::vector<float>& x, std::vector<float>& y);

}  // namespace evbench::str
