#include "bench/render/motion_compensation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/support/error.hpp"
#include "core/support/index.hpp"

namespace evbench {
namespace {

/// Adds 1, shared among the four pixels around p.
void splat(cv::Mat1f& image, const Vector2& p) {
  const double x = std::floor(p.x()), y = std::floor(p.y());
  const double fx = p.x() - x, fy = p.y() - y;
  const auto add = [&](double column, double row, double share) {
    if (column < 0.0 || row < 0.0 || column >= image.cols || row >= image.rows) return;
    image(static_cast<int>(row), static_cast<int>(column)) += static_cast<float>(share);
  };
  add(x, y, (1.0 - fx) * (1.0 - fy));
  add(x + 1.0, y, fx * (1.0 - fy));
  add(x, y + 1.0, (1.0 - fx) * fy);
  add(x + 1.0, y + 1.0, fx * fy);
}

/// The number that this share of the pixels with events does not exceed; at least 1.
float count_quantile(const cv::Mat1f& total, double share) {
  std::vector<float> counts;
  std::copy_if(total.begin(), total.end(), std::back_inserter(counts), [](float count) { return count > 0.0F; });
  if (counts.empty()) return 1.0F;
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(counts.size() - 1));
  std::nth_element(counts.begin(), counts.begin() + rank, counts.end());
  return std::max(1.0F, counts[index(rank)]);
}

}  // namespace

MotionCompensation::MotionCompensation(const PoseTrajectory& trajectory, const Camera& camera,
                                       std::optional<double> depth, std::string name)
    : trajectory_(&trajectory),
      camera_(camera),
      depth_(depth),
      name_(std::move(name)),
      ray_min_(Vector2::Constant(std::numeric_limits<double>::infinity())),
      ray_max_(-ray_min_) {
  rays_.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      std::optional<Vector3>& ray = rays_.emplace_back();
      const std::optional<Vector2> ideal = camera.undistort(Vector2(x, y));
      if (!ideal) continue;
      ray = camera.pinhole.ray(*ideal);
      ray_min_ = ray_min_.cwiseMin(ray->head<2>());
      ray_max_ = ray_max_.cwiseMax(ray->head<2>());
    }
  }
}

SE3 MotionCompensation::pose(std::int64_t t) const {
  const double seconds = static_cast<double>(t) * 1e-6;
  if (const std::optional<SE3> pose = trajectory_->pose(seconds)) return *pose;
  throw InputError(
      fmt::format("{}: has poses from {:.6f} to {:.6f} s, none at {:.6f} s, which the picture needs; "
                  "choose the time with --from and --to",
                  name_, trajectory_->start(), trajectory_->end(), seconds));
}

/// Projects the ray of an event at its time into the camera at the reference time.
std::optional<Vector2> MotionCompensation::project(const SE3& T_reference_event, const Vector3& ray) const {
  Vector3 point = T_reference_event.q * ray;
  if (depth_) {
    const double range = (*depth_ - T_reference_event.p.z()) / point.z();
    if (!(range > 0.0)) return std::nullopt;
    point = range * point + T_reference_event.p;
  }
  if (!(point.z() > 0.0)) return std::nullopt;
  // Far outside the image a lens model may fold back into it.
  const Vector2 direction = point.hnormalized();
  if ((direction.array() < ray_min_.array()).any() || (direction.array() > ray_max_.array()).any()) return std::nullopt;
  return camera_.project(point);
}

PolarityCounts MotionCompensation::accumulate(std::span<const Event> events, std::int64_t reference,
                                              std::int64_t zero) const {
  const cv::Size size(camera_.width, camera_.height);
  PolarityCounts counts{cv::Mat1f(size, 0.0F), cv::Mat1f(size, 0.0F)};
  if (events.empty()) return counts;
  const SE3 T_reference_world = pose(reference + zero).inverse();
  std::int64_t t = std::numeric_limits<std::int64_t>::min();
  SE3 T_reference_event;
  for (const Event& event : events) {
    if (event.t != t) T_reference_event = T_reference_world * pose(event.t + zero);
    t = event.t;
    const auto& ray = rays_[index(event.y * camera_.width + event.x)];
    const std::optional<Vector2> pixel = ray ? project(T_reference_event, *ray) : std::nullopt;
    if (pixel) splat(event.on ? counts.on : counts.off, *pixel);
  }
  return counts;
}

Picture draw_counts(const PolarityCounts& counts, const Palette& palette) {
  cv::Mat1f total;
  cv::add(counts.on, counts.off, total);
  const float full = count_quantile(total, 0.95);
  Picture picture(total.size(), palette.background);
  for (int y = 0; y < total.rows; ++y) {
    for (int x = 0; x < total.cols; ++x) {
      if (total(y, x) <= 0.0F) continue;
      const Colour colour = blend(palette.off, palette.on, counts.on(y, x) / total(y, x));
      picture(y, x) = blend(palette.background, colour, total(y, x) / full);
    }
  }
  return picture;
}

}  // namespace evbench
