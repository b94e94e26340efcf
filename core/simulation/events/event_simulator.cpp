#include "core/simulation/events/event_simulator.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <tuple>

#include "core/events/event_time.hpp"
#include "core/simulation/events/photoreceptor.hpp"
#include "core/support/index.hpp"
#include "core/support/parallel.hpp"

namespace evbench {
namespace {

constexpr std::size_t kChunk = 16384;

/// A line that is wrong by less than this share of the threshold is good enough, however slowly the intensity changes.
constexpr double kNegligible = 0.005;

/// A pixel's path through an interval, which is halved until straight lines are good enough.
class PixelPath {
 public:
  PixelPath(const Brightness& brightness, const SimulatorOptions& options, double from, double to, int x, int y)
      : brightness_(brightness), options_(options), from_(from), length_(to - from), x_(x), y_(y) {
    negligible_ = kNegligible * std::min(options.sensor.threshold_on, options.sensor.threshold_off);
    accuracy_ = options.time_accuracy;
    if (brightness.displacement() > 0.0) {
      accuracy_ = std::max(accuracy_, options.place_accuracy / brightness.displacement() * length_);
    }
  }

  /// Advances the pixel from part `first`, where it is, to part `last` with log intensity L.
  void advance(Pixel& pixel, int first, int last, double L, std::vector<Event>& events) const {
    if (last - first == 1 || !pixel.fires(time(last), L)) {
      pixel.advance(options_.sensor, time(last), L, events);
      return;
    }
    const int middle = (first + last) / 2;
    const double L_first = pixel.log_intensity(), L_middle = brightness_.within(x_, y_, middle);
    const double error = std::abs(L_middle - 0.5 * (L_first + L));
    const double slope = std::abs(L - L_first) / (time(last) - time(first));
    if (error <= std::max(negligible_, slope * accuracy_)) {
      pixel.advance(options_.sensor, time(middle), L_middle, events);
      pixel.advance(options_.sensor, time(last), L, events);
      return;
    }
    advance(pixel, first, middle, L_middle, events);
    advance(pixel, middle, last, L, events);
  }

 private:
  double time(int part) const { return from_ + length_ * part / Brightness::kParts; }

  const Brightness& brightness_;
  const SimulatorOptions& options_;
  double from_, length_, negligible_, accuracy_;
  int x_, y_;
};

}  // namespace

void SimulatorOptions::declare(OptionSet& set) {
  set.group("sensor", sensor, "the pixels");
  set.add("time_accuracy", time_accuracy, "error of event times from straight lines in log intensity [s]")
      .range(1e-7, 1.0);
  set.add("place_accuracy", place_accuracy, "the same where the image moves fast: so far it may move in that time [px]")
      .range(0.0, 1.0);
  set.add("threads", threads, "threads; 0: one a processor; they do not change the events").range(0, 1024);
  set.add("outages", outages, "spans without read-out, during which pixels go on [from, to, from, to, ...] [s]");
}

EventSimulator::EventSimulator(std::unique_ptr<Brightness> brightness, const SimulatorOptions& options, double duration,
                               std::uint64_t seed)
    : brightness_(std::move(brightness)),
      options_(options),
      outages_(parse_time_spans(options.outages, "simulator.outages")),
      duration_(duration),
      seed_(seed),
      faults_("simulated events", false) {
  if (options.sensor.bandwidth > 0.0) {
    brightness_ = std::make_unique<Photoreceptor>(std::move(brightness_), options.sensor.bandwidth);
  }
  info_.format = "simulated events";
  info_.width = brightness_->width();
  info_.height = brightness_->height();
  rows_.resize(static_cast<std::size_t>(info_.height));
  restart();
}

void EventSimulator::restart() {
  t_ = interval_end_ = 0.0;
  brightness_->start(0.0);
  const std::span<const float> image = brightness_->image();
  pixels_.clear();
  pixels_.reserve(image.size());
  quiet_.clear();
  for (std::size_t i = 0; i < image.size(); ++i) {
    pixels_.emplace_back(options_.sensor, seed_, i, 0.0, image[i]);
    quiet_.push_back(pixels_.back().quiet());
  }
  waiting_.clear();
  ready_.clear();
}

void EventSimulator::seek(std::int64_t t) {
  const std::int64_t now = ready_.empty() ? static_cast<std::int64_t>(t_ * 1e6) : ready_.front().t;
  if (t_ > 0.0 && t < now) restart();
  while (t_ < duration_ && (ready_.empty() || ready_.back().t < t)) {
    ready_.clear();
    step();
  }
}

bool EventSimulator::read(std::vector<Event>& events) {
  while (ready_.size() < kChunk && t_ < duration_) step();
  events.clear();
  std::swap(events, ready_);
  return !events.empty();
}

void EventSimulator::step() {
  const std::span<const float> image = brightness_->image();
  last_image_.assign(image.begin(), image.end());
  interval_end_ = brightness_->advance(duration_);
  parallel_for(options_.threads, info_.height, [this](int y) { advance_row(y); });
  t_ = interval_end_;
  for (std::vector<Event>& row : rows_) {
    std::ranges::copy_if(row, std::back_inserter(waiting_), [this](const Event& event) { return is_read_out(event); });
    row.clear();
  }
  // Jitter is at most four standard deviations, and times are rounded.
  release(t_ < duration_ ? t_ - 4.0 * options_.sensor.jitter : std::numeric_limits<double>::infinity());
}

void EventSimulator::advance_row(int y) {
  const std::span<const float> image = brightness_->image();
  std::size_t pixel = index(y) * index(info_.width);
  for (int x = 0; x < info_.width; ++x, ++pixel) {
    if (quiet_[pixel].holds(interval_end_, image[pixel])) continue;
    pixels_[pixel].skip(t_, last_image_[pixel]);
    advance_pixel(x, y, rows_[index(y)]);
    quiet_[pixel] = pixels_[pixel].quiet();
  }
}

void EventSimulator::advance_pixel(int x, int y, std::vector<Event>& events) {
  const std::size_t pixel = index(y) * index(info_.width) + index(x);
  const std::size_t before = events.size();
  const PixelPath path(*brightness_, options_, t_, interval_end_, x, y);
  path.advance(pixels_[pixel], 0, Brightness::kParts, brightness_->image()[pixel], events);
  for (std::size_t i = before; i < events.size(); ++i) {
    events[i].x = static_cast<std::uint16_t>(x);
    events[i].y = static_cast<std::uint16_t>(y);
  }
}

bool EventSimulator::is_read_out(const Event& event) const {
  const double t = seconds(event.t);
  return std::ranges::none_of(outages_, [t](const TimeSpan& span) { return t >= span.from && t < span.to; });
}

/// Makes the waiting events before a time [s] ready for reading.
void EventSimulator::release(double until) {
  const auto key = [](const Event& event) { return std::tuple(event.t, event.y, event.x); };
  std::ranges::stable_sort(waiting_, {}, key);
  auto end = waiting_.end();
  if (std::isfinite(until)) {
    end = std::ranges::lower_bound(waiting_, static_cast<std::int64_t>(std::floor(until * 1e6)), {}, &Event::t);
  }
  ready_.insert(ready_.end(), waiting_.begin(), end);
  waiting_.erase(waiting_.begin(), end);
}

}  // namespace evbench
