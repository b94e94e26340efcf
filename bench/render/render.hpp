#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/render/palette.hpp"
#include "core/data/pose_file.hpp"
#include "core/events/event_stream.hpp"

namespace evbench {

enum class RenderMode {
  events,        ///< event_image.hpp
  time_surface,  ///< time_surface.hpp
  compensated,   ///< motion_compensation.hpp, at the middle of each picture's events
};

struct RenderOptions {
  StreamOptions stream;
  RenderMode mode = RenderMode::events;
  /// The events in a picture: of a duration [s], or a number of events. Where neither is given: the range of --from and
  /// --to for a single picture with both; five times the decay for time surfaces; otherwise 20 ms, in a video at least
  /// the time between two pictures and at most ten times that.
  std::optional<double> duration;
  std::optional<std::size_t> count;
  double decay = 0.03;             ///< of time surfaces [s]
  double fps = 30.0, speed = 1.0;  ///< pictures a second of playback; seconds of the recording in one of playback
  std::optional<int> scale;        ///< pixels a sensor pixel; none: so many that the sensor has 640 or more across
  bool dark = false;
  bool time = false;                                        ///< whether pictures show the time (time_label.hpp)
  std::string tracks;                                       ///< file `id t x y`, drawn over `in`; empty: none
  double tail = 0.1;                                        ///< of tracks [s]
  std::string trajectory;                                   ///< for compensation; empty: the recording's own
  QuaternionOrder quaternion = QuaternionOrder::automatic;  ///< of the trajectory's columns
  std::string calibration;                                  ///< for compensation; empty: the recording's own
  std::string camera;                                       ///< of a calibration of several; empty: the only one
  std::optional<double> depth;  ///< of the plane [m]; none: only the rotation is compensated
  std::string run;              ///< folder of a run with tracks, drawn over `in` and at its side; empty: none
  std::string beside;           ///< another recording, at the right; empty: none
};

struct RenderReport {
  std::int64_t pictures = 0;
  cv::Size size;                                              ///< of a picture
  std::vector<std::pair<std::string, Faults::Fault>> faults;  ///< of the recordings, left out
  std::vector<std::string> remarks;                           ///< sentences: what may not be drawn as expected
};

/// Draws a recording to `out` (picture_sink.hpp). The first picture shows the beginning of the time range; the next
/// ones follow every speed / fps seconds (not less than 1 µs), up to the one that shows the last event. Times of tracks
/// and trajectory are the file's own. Without --from or --to, compensation draws the time that the trajectory covers.
/// `progress` is called with the number of pictures and their time [µs]. Throws InputError for files that can't be read
/// or written, times without events, a trajectory that does not cover them, and options that don't fit.
RenderReport render(const std::string& in, const std::string& out, const RenderOptions& options,
                    const std::function<void(std::int64_t, std::int64_t)>& progress = {});

}  // namespace evbench
