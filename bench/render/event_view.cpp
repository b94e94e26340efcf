#include "bench/render/event_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "bench/render/event_image.hpp"
#include "bench/render/time_surface.hpp"
#include "core/data/calib.hpp"
#include "core/data/pose_file.hpp"
#include "core/events/sensor_size.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

/// The sensor size of the recording; where it is unknown, the size that the events in the time range need.
cv::Size sensor_size(const std::string& path, const StreamOptions& options, const StreamInfo& info) {
  if (info.width > 0 && info.height > 0) return {info.width, info.height};
  cv::Size size(1, 1);
  EventStream stream(path, options);
  for (std::vector<Event> events; stream.read(events);) {
    for (const Event& event : events) {
      size.width = std::max(size.width, event.x + 1);
      size.height = std::max(size.height, event.y + 1);
    }
  }
  check_sensor_size(path, size.width, size.height);
  return size;
}

}  // namespace

PoseFile motion_of(const std::string& path, const RenderOptions& options, EventStream& stream) {
  if (!options.trajectory.empty()) return read_poses(options.trajectory, {.quaternion = options.quaternion});
  PoseFile own;
  own.trajectory = stream.reader().ground_truth().value_or(PoseTrajectory());
  if (!own.trajectory.empty()) return own;
  throw InputError(fmt::format("{}: has no ground truth; compensation needs --trajectory", path));
}

Camera camera_of(const std::string& path, const RenderOptions& options, EventStream& stream, const cv::Size& sensor,
                 const std::string& what) {
  const std::optional<Camera> camera = options.calibration.empty()
                                           ? stream.reader().calibration()
                                           : read_calib(options.calibration, sensor.width, sensor.height,
                                                        DistortionModel::radial_tangential, options.camera);
  if (!camera) throw InputError(fmt::format("{}: has no calibration; {} needs --calib", path, what));
  if (camera->width != sensor.width || camera->height != sensor.height) {
    throw InputError(fmt::format("{}: calibration of {}x{} pixels; expected the sensor's {}x{}", path, camera->width,
                                 camera->height, sensor.width, sensor.height));
  }
  return *camera;
}

EventView::EventView(const std::string& path, const RenderOptions& options, const WindowExtent& extent)
    : stream_(path, options.stream),
      size_(sensor_size(path, options.stream, stream_.info())),
      window_(stream_, extent),
      mode_(options.mode),
      palette_(options.dark ? dark_palette() : light_palette()),
      decay_(options.decay * 1e6) {
  if (mode_ == RenderMode::compensated) prepare_compensation(path, options);
}

void EventView::prepare_compensation(const std::string& path, const RenderOptions& options) {
  const std::string whose = options.trajectory.empty() ? path : options.trajectory;
  trajectory_ = motion_of(path, options, stream_).trajectory;
  const Camera camera = camera_of(path, options, stream_, size_, "compensation");
  compensation_.emplace(trajectory_, camera, options.depth, whose);
}

EventView::Sight EventView::before(std::int64_t t) {
  const std::span<const Event> events = window_.before(t);
  const bool any = !events.empty();
  // Not after the end of the recording, where a time surface would have faded, and no time must be shown.
  if (any && !window_.next()) t = std::min(t, events.back().t);
  switch (mode_) {
    case RenderMode::events: break;
    case RenderMode::time_surface: return {draw_time_surface(time_surface(events, size_, t, decay_), palette_), t, any};
    case RenderMode::compensated:
      // The middle of the events, not of the window: a trajectory may end with the events.
      if (any) t = std::midpoint(events.front().t, events.back().t);
      return {draw_counts(compensation_->accumulate(events, t, stream_.zero()), palette_), t, any};
  }
  return {draw_events(events, size_, palette_), t, any};
}

}  // namespace evbench
