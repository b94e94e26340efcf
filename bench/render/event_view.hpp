#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bench/render/event_window.hpp"
#include "bench/render/motion_compensation.hpp"
#include "bench/render/palette.hpp"
#include "bench/render/render.hpp"

namespace evbench {

/// The motion for compensation: the file that the options name, or the recording's own. Throws InputError where there
/// is neither. Assumptions on a file are in its remarks.
PoseFile motion_of(const std::string& path, const RenderOptions& options, EventStream& stream);

/// The camera: of the file that the options name, or the recording's own. Throws InputError where there is neither, and
/// where it is not of the sensor's size. `what`: the part that needs it, for the message.
Camera camera_of(const std::string& path, const RenderOptions& options, EventStream& stream, const cv::Size& sensor,
                 const std::string& what);

/// Draws one recording at a time. Reads the events that it needs; time moves forward.
class EventView {
 public:
  EventView(const std::string& path, const RenderOptions& options, const WindowExtent& extent);
  EventView(const EventView&) = delete;
  EventView& operator=(const EventView&) = delete;

  struct Sight {
    Picture picture;     ///< a sensor pixel a pixel
    std::int64_t t = 0;  ///< time of the picture [µs]: the end of its events' time, or the time they are moved to
    bool has_events = false;
  };
  Sight before(std::int64_t t);

  EventStream& stream() { return stream_; }
  EventWindow& window() { return window_; }
  cv::Size size() const { return size_; }  ///< sensor [px]

 private:
  void prepare_compensation(const std::string& path, const RenderOptions& options);

  EventStream stream_;
  cv::Size size_;
  EventWindow window_;
  RenderMode mode_;
  Palette palette_;
  double decay_;               ///< [µs]
  PoseTrajectory trajectory_;  ///< for compensation, as is:
  std::optional<MotionCompensation> compensation_;
};

}  // namespace evbench
