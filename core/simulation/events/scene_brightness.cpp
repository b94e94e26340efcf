#include "core/simulation/events/scene_brightness.hpp"

#include <algorithm>
#include <cmath>

#include "core/support/index.hpp"

namespace evbench {
namespace {

constexpr double kLongest = 0.01, kShortest = 1e-6;  // [s] of an interval
constexpr int kStride = 8;                           // [px] between probes

}  // namespace

void RenderingOptions::declare(OptionSet& set) {
  set.add("max_displacement", max_displacement, "largest motion of a point over the image between renderings [px]")
      .range(0.01, 1.0);
  set.add("blur", optics.blur, "standard deviation of a pixel's average over its area and the optics [px]")
      .range(0.2, 20.0);
  set.add("vignetting", optics.vignetting, "share of the light that is lost at the image's corners").range(0.0, 0.95);
}

SceneBrightness::SceneBrightness(const Camera& camera, std::shared_ptr<const RenderedScene> scene, Motion motion,
                                 const RenderingOptions& options, int threads)
    : scene_(std::move(scene)),
      motion_(std::move(motion)),
      options_(options),
      threads_(threads),
      renderer_(camera, scene_->surfaces, scene_->texture, options.optics, scene_->light) {}

void SceneBrightness::start(double t) {
  from_ = to_ = t;
  last_length_ = 1e-3;
  renderer_.render(motion_(t), threads_, frame_);
}

double SceneBrightness::advance(double limit) {
  const SE3 T = motion_(to_);
  const View view = renderer_.view(T);
  probes_.clear();
  for (int y = kStride / 2; y < height(); y += kStride) {
    for (int x = kStride / 2; x < width(); x += kStride) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width()) + static_cast<std::size_t>(x);
      if (frame_.hits[i].surface < 0) continue;
      const Vector3 ray = renderer_.ray(i).homogeneous();
      const View::Face face = view.face(frame_.hits[i]);
      const Vector3 local = face.distance / face.normal.dot(ray) * ray;
      probes_.push_back({renderer_.camera().pinhole.project(local), T * local});
    }
  }
  from_ = to_;
  to_ = choose_end(limit);
  last_length_ = to_ - from_;
  std::swap(frame_, last_);
  views_.clear();
  for (int part = 1; part < kParts; ++part) {
    views_.push_back(renderer_.view(motion_(from_ + (to_ - from_) * part / kParts)));
  }
  if (moved_ <= 1.0) {
    renderer_.render_next(motion_(to_), threads_, last_, frame_);
  } else {  // in an instant that is shorter than the shortest interval
    renderer_.render(motion_(to_), threads_, frame_);
  }
  return to_;
}

/// The largest displacement of a probe over the image [px], once the camera has moved to the pose.
double SceneBrightness::displacement_at(const SE3& T_world_camera) const {
  const SE3 T_camera_world = T_world_camera.inverse();
  double largest = 0.0;
  for (const Probe& probe : probes_) {
    const Vector3 local = T_camera_world * probe.point;
    if (local.z() <= 0.0) continue;
    largest = std::max(largest, (renderer_.camera().pinhole.project(local) - probe.pixel).squaredNorm());
  }
  return std::sqrt(largest);
}

/// Starts from the last interval's length and scales it by the ratio of displacements.
double SceneBrightness::choose_end(double limit) {
  constexpr int kAttempts = 8;
  double length = last_length_;
  for (int i = 0; i < kAttempts; ++i) {
    moved_ = displacement_at(motion_(std::min(from_ + length, limit)));
    const bool small = moved_ < 0.7 * options_.max_displacement && length < kLongest;
    if (moved_ <= options_.max_displacement && !small) break;
    const double ratio = 0.9 * options_.max_displacement / std::max(moved_, 1e-9);
    length = std::clamp(length * std::clamp(ratio, 0.1, 10.0), kShortest, kLongest);
  }
  return std::min(from_ + length, limit);
}

float SceneBrightness::within(int x, int y, int part) const {
  const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width()) + static_cast<std::size_t>(x);
  return renderer_.pixel(views_[index(part - 1)], i, last_, frame_);
}

}  // namespace evbench
