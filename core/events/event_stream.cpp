#include "core/events/event_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>

#include "core/events/formats.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

constexpr std::int64_t kBeginning = std::numeric_limits<std::int64_t>::min();

/// All in time order, none before `from`, all within the sensor? Without branches and in the narrowest types, so that
/// it is vectorised: this is asked of every event.
bool are_fine(std::span<const Event> events, std::int64_t from, int width, int height) {
  const auto last_x = static_cast<std::uint32_t>(width - 1), last_y = static_cast<std::uint32_t>(height - 1);
  std::uint64_t back = events.front().t < from;
  std::uint32_t outside = (last_x - events.front().x) | (last_y - events.front().y);  // in the highest bit
  for (std::size_t i = 1; i < events.size(); ++i) {
    back |= static_cast<std::uint64_t>(events[i].t < events[i - 1].t);
    outside |= (last_x - events[i].x) | (last_y - events[i].y);
  }
  return back == 0 && outside >> 31 == 0;
}

}  // namespace

void check_sensor_size(const std::string& path, int width, int height) {
  constexpr std::int64_t kMost = 64'000'000;
  if (std::int64_t{width} * height <= kMost) return;
  throw InputError(fmt::format("{}: a sensor of {}x{} pixels; expected {} million pixels at most", path, width, height,
                               kMost / 1'000'000));
}

EventStream::EventStream(const std::string& path, const StreamOptions& options)
    : EventStream(open_events(path, options.read), path, options) {}

EventStream::EventStream(std::unique_ptr<EventReader> reader, std::string path, const StreamOptions& options)
    : path_(std::move(path)),
      reader_(std::move(reader)),
      options_(options),
      faults_(path_, options.read.strict),
      from_(kBeginning),
      newest_(kBeginning) {
  check_sensor_size(path_, info().width, info().height);
  if (options.rebase) {
    std::vector<Event> first;
    if (reader_->read(first) && !first.empty()) zero_ = first.front().t;
    reader_->seek(kBeginning);
  }
  if (options.from) seek(*options.from);
}

void EventStream::seek(std::int64_t t) {
  from_ = t + zero_;
  newest_ = kBeginning;
  ended_ = false;
  reader_->seek(from_);
}

bool EventStream::read(std::vector<Event>& events) {
  while (!ended_ && reader_->read(events)) {
    check_interruption();
    check(events);
    if (!events.empty()) return true;
  }
  events.clear();
  ended_ = true;
  return false;
}

/// Keeps what is in order, in the sensor, and in the range, with times of the stream.
void EventStream::check(std::vector<Event>& events) {
  const int width = info().width > 0 ? info().width : 1 << 16, height = info().height > 0 ? info().height : 1 << 16;
  const std::int64_t end = options_.to ? *options_.to + zero_ : std::numeric_limits<std::int64_t>::max();
  if (events.empty()) return;
  if (events.back().t < end && are_fine(events, std::max(newest_, from_), width, height)) {
    newest_ = events.back().t;
    if (zero_ != 0) {
      for (Event& event : events) event.t -= zero_;
    }
    return;
  }
  // Told once a chunk: a recording may be nothing but faults.
  std::int64_t outside = 0, backwards = 0;
  std::string first_outside, first_backwards;
  std::size_t kept = 0;
  for (const Event& event : events) {
    if (event.x >= width || event.y >= height) {
      if (outside++ == 0) first_outside = fmt::format("{} us, pixel ({}, {})", event.t, event.x, event.y);
      continue;
    }
    if (event.t < newest_) {
      if (backwards++ == 0) first_backwards = fmt::format("{} us after {} us", event.t, newest_);
      continue;
    }
    newest_ = event.t;
    if (event.t < from_) continue;
    if (event.t >= end) {
      ended_ = true;
      break;
    }
    events[kept] = event;
    events[kept++].t -= zero_;
  }
  if (outside > 0) {
    faults_.add(fmt::format("events outside the sensor of {}x{} pixels", width, height), first_outside, outside);
  }
  if (backwards > 0) faults_.add("events that go back in time", first_backwards, backwards);
  events.resize(kept);
}

std::vector<std::pair<std::string, Faults::Fault>> EventStream::faults() const {
  std::vector<std::pair<std::string, Faults::Fault>> all(reader_->faults().all().begin(),
                                                         reader_->faults().all().end());
  all.insert(all.end(), faults_.all().begin(), faults_.all().end());
  return all;
}

}  // namespace evbench
