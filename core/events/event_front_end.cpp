#include "core/events/event_front_end.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/events/event_time.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

std::unique_ptr<EventStream> events_of(const FrontEndContext& context, const std::string& name) {
  auto events = context.source.events();
  if (!events) {
    throw InputError(
        fmt::format("{}: {} works on events, and this source has none; expected a recording of events or the source "
                    "event_simulation",
                    context.place, name));
  }
  return events;
}

/// Do events with these largest coordinates leave a fifth of the sensor free on both sides, and are they enough to say
/// so? The two sizes of DAVIS sensors differ by a factor of 0.69.
bool leave_much_free(int max_x, int max_y, const Camera& camera, std::int64_t events) {
  return events >= 10'000 && max_x + 1 < 0.8 * camera.width && max_y + 1 < 0.8 * camera.height;
}

}  // namespace

void expect_events(const SensorData& source, const std::string& place) {
  if (source.silence_is_known()) return;
  std::vector<Event> first;
  if (const auto events = source.events(); !events || events->read(first)) return;
  const auto reader = source.all_events();
  while (reader->read(first) && first.empty()) {
  }
  const std::string found =
      first.empty() ? "it has none at all" : fmt::format("its first one is at {:.6f} s", seconds(first.front().t));
  const TimeRange range = source.time_range();
  throw InputError(fmt::format("{}: the recording has no events from {} to {} s, the source's time range; {}", place,
                               range.from, range.to, found));
}

EventFrontEnd::EventFrontEnd(const FrontEndContext& context, const std::string& name)
    : camera_(context.source.camera()),
      range_(context.source.time_range()),
      delayed_(range_.from),
      clock_(range_.from),
      source_(context.source),
      place_(context.place),
      feed_(events_of(context, name)),
      silence_is_known_(context.source.silence_is_known()) {}

bool EventFrontEnd::advance(const Horizon& horizon, TrackBatch& batch) {
  const auto enough = [&] { return horizon.observations > 0 && delayed_.has(horizon.observations, complete()); };
  while (clock_ < horizon.t && !is_over() && !enough()) {
    const double tick = range_.from + static_cast<double>(ticks_ + 1) * kTick;
    follow(std::min(tick, horizon.t));
    if (clock_ < tick && clock_ < range_.to) continue;
    ++ticks_;
    on_tick();
  }
  if (is_over() && events_ == 0) expect_events(source_, place_);
  delayed_.release(is_over() ? clock_ : complete(), horizon.observations, batch);
  batch.seen = clock_;
  return !is_over() || !delayed_.empty();
}

/// Takes all events up to t.
void EventFrontEnd::follow(double t) {
  const std::int64_t until = microseconds(t);
  for (auto events = feed_.until(until); !events.empty(); events = feed_.until(until)) {
    events_ += std::ssize(events);
    take(events);
  }
  clock_ = t;
}

std::optional<double> EventFrontEnd::data_end() const {
  return is_over() && clock_ < range_.to ? std::optional(clock_) : std::nullopt;
}

std::vector<std::string> EventFrontEnd::remarks() const {
  std::vector<std::string> result = counts();
  result.push_back(fmt::format("{} events", events_));
  const EventStream& stream = feed_.stream();
  for (const auto& [kind, fault] : stream.faults()) {
    result.push_back(fmt::format("left out: {} {} (the first: {})", fault.count, kind, fault.first));
  }
  if (const int x = stream.max_x(), y = stream.max_y(); leave_much_free(x, y, camera_, events_)) {
    result.push_back(
        fmt::format("the events reach no farther than pixel ({}, {}) of a sensor of {}x{} pixels: is the calibration "
                    "another camera's?",
                    x, y, camera_.width, camera_.height));
  }
  if (const auto end = data_end()) {
    result.push_back(fmt::format("the events end at {:.3f} s, before the time range does, {:.3f} s: so does the run",
                                 *end, range_.to));
  }
  return result;
}

}  // namespace evbench
