#include "bench/render/render.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "bench/render/event_view.hpp"
#include "bench/render/picture_sink.hpp"
#include "bench/render/run_overlay.hpp"
#include "bench/render/time_label.hpp"
#include "bench/render/track_overlay.hpp"
#include "core/data/tracks.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

constexpr double kMaxStill = 1e5;  // pictures without an event; more come from an error of the clock

std::int64_t microseconds(double seconds) { return std::max<std::int64_t>(1, std::llround(seconds * 1e6)); }

WindowExtent make_extent(const RenderOptions& options, bool one_picture, std::int64_t period) {
  WindowExtent extent;
  extent.count = options.count;
  if (options.duration) {
    extent.duration = microseconds(*options.duration);
  } else if (one_picture && options.stream.from && options.stream.to) {
    extent.duration = *options.stream.to - *options.stream.from;
  } else {
    extent.duration = 20000;
    if (!one_picture) extent.duration = std::max(period, std::min(extent.duration, 10 * period));
    if (options.mode == RenderMode::time_surface) extent.duration = microseconds(5.0 * options.decay);
  }
  return extent;
}

/// The end of the first picture's time. Opens the stream separately, as for a count the time is known only by reading.
std::int64_t first_end(const std::string& path, const StreamOptions& options, const WindowExtent& extent) {
  EventStream stream(path, options);
  std::vector<Event> events;
  std::size_t count = 0;
  std::int64_t newest = 0;
  while (stream.read(events)) {
    if (!extent.count) return options.from.value_or(events.front().t) + extent.duration;
    if (count + events.size() >= *extent.count) return events[*extent.count - count - 1].t + 1;
    count += events.size();
    newest = events.back().t;
  }
  if (count == 0) throw InputError(fmt::format("{}: has no events in the time range that is asked for", path));
  return newest + 1;
}

void check_options(const RenderOptions& options) {
  const bool compensated = options.mode == RenderMode::compensated;
  if (!compensated && (!options.trajectory.empty() || options.depth)) {
    throw InputError("trajectory and depth are for motion-compensated pictures; this mode has no use for them");
  }
  if (!compensated && options.run.empty() && !options.calibration.empty()) {
    throw InputError("a calibration is for motion-compensated pictures and for those of a run; this has no use for it");
  }
  if (options.speed / options.fps < 1e-6) {
    throw InputError(fmt::format("{} pictures a second at speed {}: one every {:.3g} us; expected 1 us or more",
                                 options.fps, options.speed, options.speed / options.fps * 1e6));
  }
}

int make_scale(const RenderOptions& options, int width) { return options.scale.value_or((640 + width - 1) / width); }

Picture enlarge(const Picture& picture, int scale) {
  Picture large;
  cv::resize(picture, large, {}, scale, scale, cv::INTER_NEAREST);
  return large;
}

/// Puts two pictures side by side with a bar between, aligned at the top.
Picture side_by_side(const Picture& left, const Picture& right, const Palette& palette) {
  constexpr int kBar = 4;
  const int height = std::max(left.rows, right.rows);
  Picture both(height, left.cols + kBar + right.cols, palette.background);
  left.copyTo(both(cv::Rect(0, 0, left.cols, left.rows)));
  both(cv::Rect(left.cols, 0, kBar, height)).setTo(palette.frame);
  right.copyTo(both(cv::Rect(left.cols + kBar, 0, right.cols, right.rows)));
  return both;
}

/// Draws the pictures in time order.
class Renderer {
 public:
  Renderer(const std::string& in, const RenderOptions& options, const WindowExtent& extent)
      : palette_(options.dark ? dark_palette() : light_palette()),
        with_time_(options.time),
        in_(in),
        beside_path_(options.beside),
        main_(in, options, extent),
        scale_(make_scale(options, main_.size().width)) {
    if (!options.tracks.empty()) {
      tracks_.emplace(read_tracks(options.tracks, main_.size().width, main_.size().height).observations, options.tail);
    }
    if (!options.run.empty()) {
      const Camera camera = camera_of(in, options, main_.stream(), main_.size(), "a run");
      run_.emplace(options.run, camera);
      tracks_.emplace(run_->tracks(), options.tail);
    }
    if (!options.beside.empty()) beside_.emplace(options.beside, options, extent);
  }

  Picture before(std::int64_t t) {
    const EventView::Sight sight = main_.before(t);
    drawn_ |= sight.has_events;
    Picture picture = enlarge(sight.picture, scale_);
    const double now = static_cast<double>(sight.t + main_.stream().zero()) * 1e-6;
    if (run_) run_->draw_landmarks(now, scale_, palette_, picture);
    if (tracks_) {
      drawn_tracks_ |= tracks_->draw(now, scale_, palette_, picture);
    }
    if (with_time_) draw_time(sight.t, palette_, picture);
    if (run_) picture = side_by_side(picture, run_->draw_trajectory(now, picture.rows, palette_), palette_);
    if (!beside_) return picture;
    const EventView::Sight other = beside_->before(t);
    drawn_beside_ |= other.has_events;
    return side_by_side(picture, enlarge(other.picture, scale_), palette_);
  }

  /// Throws InputError when nothing but empty pictures were drawn of a recording.
  void expect_events() const {
    constexpr const char* kNone =
        "{}: has no events at the times that are drawn; choose them with --from, --to, --rebase";
    if (!drawn_) throw InputError(fmt::format(kNone, in_));
    if (beside_ && !drawn_beside_) throw InputError(fmt::format(kNone, beside_path_));
  }

  std::string run_remark() const { return run_ ? run_->remark() : ""; }
  bool lacks_tracks() const { return tracks_ && !drawn_tracks_; }
  std::string tracks_range() const { return tracks_->range_text(); }

  /// Time of the first event that is still to be drawn.
  std::optional<std::int64_t> next() { return main_.window().next(); }

  std::vector<std::pair<std::string, Faults::Fault>> faults() {
    auto all = main_.stream().faults();
    if (beside_) {
      for (auto& fault : beside_->stream().faults()) all.push_back(std::move(fault));
    }
    return all;
  }

 private:
  Palette palette_;
  bool with_time_;
  std::string in_, beside_path_;
  EventView main_;
  int scale_;
  std::optional<RunOverlay> run_;
  std::optional<TrackOverlay> tracks_;
  std::optional<EventView> beside_;
  bool drawn_ = false, drawn_beside_ = false;  ///< whether any event was drawn
  bool drawn_tracks_ = false;
};

/// Restricts compensation without --from or --to to the time that the trajectory covers, with a remark where that is
/// not the whole recording.
RenderOptions within_motion(const std::string& in, const RenderOptions& asked, RenderReport& report) {
  if (asked.mode != RenderMode::compensated) return asked;
  RenderOptions options = asked;
  EventStream stream(in, asked.stream);
  const PoseFile file = motion_of(in, asked, stream);
  report.remarks.insert(report.remarks.end(), file.remarks.begin(), file.remarks.end());
  if (asked.stream.from && asked.stream.to) return asked;
  const PoseTrajectory& motion = file.trajectory;
  const auto time = [&](double t, double (*round)(double)) {
    return static_cast<std::int64_t>(round(t * 1e6)) - stream.zero();
  };
  const std::int64_t start = time(motion.start(), std::ceil), end = time(motion.end(), std::floor) + 1;
  std::vector<Event> events;
  if (start >= asked.stream.to.value_or(end)) {
    throw InputError(fmt::format("{}: the trajectory begins at {:.6f} s; expected to draw a time after that", in,
                                 static_cast<double>(start) * 1e-6));
  }
  if (!asked.stream.from && stream.read(events) && events.front().t < start) {
    options.stream.from = start;
    report.remarks.push_back(fmt::format("the trajectory begins at {:.6f} s, after the events: drawn from there on",
                                         static_cast<double>(start) * 1e-6));
  }
  if (!asked.stream.to) options.stream.to = end;
  return options;
}

}  // namespace

RenderReport render(const std::string& in, const std::string& out, const RenderOptions& asked,
                    const std::function<void(std::int64_t, std::int64_t)>& progress) {
  check_options(asked);
  RenderReport report;
  const RenderOptions options = within_motion(in, asked, report);
  const std::unique_ptr<PictureSink> sink = open_picture_sink(out, options.fps);
  const double period = options.speed / options.fps * 1e6;  // [us]
  const WindowExtent extent = make_extent(asked, !sink->takes_many(), std::llround(period));
  Renderer renderer(in, options, extent);
  const std::int64_t first = first_end(in, options.stream, extent);
  while (true) {
    const std::int64_t t = first + std::llround(period * static_cast<double>(report.pictures));
    const Picture picture = renderer.before(t);
    sink->add(picture);
    report.size = picture.size();
    ++report.pictures;
    if (progress) progress(report.pictures, t);
    check_interruption();
    if (!sink->takes_many()) break;
    const std::optional<std::int64_t> next = renderer.next();
    if (!next) break;
    if (static_cast<double>(*next - t) / period > kMaxStill) {
      throw InputError(
          fmt::format("{}: has no events between {:.6f} and {:.6f} s; choose the time with --from and --to", in,
                      static_cast<double>(t) * 1e-6, static_cast<double>(*next) * 1e-6));
    }
  }
  renderer.expect_events();
  if (renderer.lacks_tracks()) {
    report.remarks.push_back(
        fmt::format("{}: none of its tracks is in view at the times that are drawn; they go from {}",
                    asked.run.empty() ? asked.tracks : asked.run, renderer.tracks_range()));
  }
  if (const std::string remark = renderer.run_remark(); !remark.empty()) report.remarks.push_back(remark);
  sink->finish();
  report.faults = renderer.faults();
  return report;
}

}  // namespace evbench
