#include "core/events/event_front_end.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/events/event_time.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr double kTick = 0.005;  // [s]

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

}  // namespace

EventFrontEnd::EventFrontEnd(const FrontEndContext& context, const std::string& name)
    : camera_(context.source.camera()),
      range_(context.source.time_range()),
      told_(range_.from),
      clock_(range_.from),
      feed_(events_of(context, name)),
      silence_is_known_(context.source.silence_is_known()) {}

bool EventFrontEnd::advance(const Horizon& horizon, TrackBatch& batch) {
  const auto enough = [&] { return horizon.observations > 0 && told_.has(horizon.observations, complete()); };
  while (clock_ < horizon.t && !is_over() && !enough()) {
    const double tick = range_.from + static_cast<double>(ticks_ + 1) * kTick;
    follow(std::min(tick, horizon.t));
    if (clock_ < tick && clock_ < range_.to) continue;
    ++ticks_;
    look();
  }
  told_.tell(is_over() ? clock_ : complete(), horizon.observations, batch);
  batch.seen = clock_;
  return !is_over() || !told_.empty();
}

/// All events up to t.
void EventFrontEnd::follow(double t) {
  const std::int64_t until = microseconds(t);
  for (auto events = feed_.until(until); !events.empty(); events = feed_.until(until)) take(events);
  clock_ = t;
}

}  // namespace evbench
