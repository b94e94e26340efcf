#include "core/events/event_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>

#include "core/events/formats.hpp"
#include "core/events/longest_in_order.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

// So that differences and sums of times can't overflow.
constexpr std::int64_t kLatest = std::int64_t{1} << 61;  // [us]

/// All in time order, none before `from` or beyond any time, all within the sensor? Without branches and in the
/// narrowest types, so that it is vectorised: this is asked of every event.
bool are_fine(std::span<const Event> events, std::int64_t from, int width, int height) {
  const auto last_x = static_cast<std::uint32_t>(width - 1), last_y = static_cast<std::uint32_t>(height - 1);
  std::uint64_t back = events.front().t < from;
  std::uint32_t outside = (last_x - events.front().x) | (last_y - events.front().y);  // in the highest bit
  for (std::size_t i = 1; i < events.size(); ++i) {
    back |= static_cast<std::uint64_t>(events[i].t < events[i - 1].t);
    outside |= (last_x - events[i].x) | (last_y - events[i].y);
  }
  return back == 0 && outside >> 31 == 0 && events.front().t >= -kLatest && events.back().t <= kLatest;
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
    : path_(std::move(path)), reader_(std::move(reader)), faults_(path_, options.read.strict) {
  check_sensor_size(path_, info().width, info().height);
  if (options.rebase) find_zero();
  if (options.to) end_ = *options.to + zero_;
  if (options.from) seek(*options.from);
}

/// Reads up to the first event that is one, and goes back. What was wrong there will be told when it is read again.
void EventStream::find_zero() {
  const std::map<std::string, Faults::Fault> at_opening = reader_->faults().all();
  std::vector<Event> first;
  if (read(first)) zero_ = first.front().t;
  for (const auto& [kind, fault] : reader_->faults().all()) {
    const auto before = at_opening.find(kind);
    rehearsed_[kind] = fault.count - (before == at_opening.end() ? 0 : before->second.count);
  }
  faults_.clear();
  newest_ = kBeginning;
  ended_ = false;
  reader_->seek(kBeginning);
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
  if (events.empty()) return;
  const int width = info().width > 0 ? info().width : 1 << 16, height = info().height > 0 ? info().height : 1 << 16;
  if (events.back().t >= end_ || !are_fine(events, std::max(newest_, from_), width, height)) {
    leave_out_outside(events, width, height);
    leave_out_disorder(events);
    if (!events.empty()) newest_ = events.back().t;
    const auto first = std::ranges::lower_bound(events, from_, {}, &Event::t);
    const auto last = std::ranges::lower_bound(events, end_, {}, &Event::t);
    ended_ = last != events.end();
    events.erase(last, events.end());
    events.erase(events.begin(), first);
  } else {
    newest_ = events.back().t;
  }
  if (zero_ == 0) return;
  for (Event& event : events) event.t -= zero_;
}

// Faults are told once a chunk: a recording may be nothing but faults.

void EventStream::leave_out_outside(std::vector<Event>& events, int width, int height) {
  std::int64_t outside = 0, beyond = 0;
  Event first_outside, first_beyond;
  std::size_t kept = 0;
  for (const Event& event : events) {
    if (event.x >= width || event.y >= height) {
      if (outside++ == 0) first_outside = event;
    } else if (event.t > kLatest || event.t < -kLatest) {
      if (beyond++ == 0) first_beyond = event;
    } else {
      events[kept++] = event;
    }
  }
  events.resize(kept);
  if (outside > 0) {
    faults_.add(fmt::format("events outside the sensor of {}x{} pixels", width, height),
                fmt::format("{} us, pixel ({}, {})", first_outside.t, first_outside.x, first_outside.y), outside);
  }
  if (beyond > 0) faults_.add("events beyond any time (2^61 us)", fmt::format("{} us", first_beyond.t), beyond);
}

void EventStream::leave_out_disorder(std::vector<Event>& events) {
  const std::size_t all = events.size();
  std::optional<std::int64_t> first_wrong;
  const auto tell = [&](const Event& event) {
    if (!first_wrong) first_wrong = event.t;
  };
  std::erase_if(events, [&](const Event& event) { return event.t < newest_ && (tell(event), true); });
  const std::vector<std::uint32_t> kept = longest_in_order(events);
  for (std::size_t i = 0, next = 0; i < events.size(); ++i) {
    if (next == kept.size() || kept[next] != i) {
      tell(events[i]);
    } else {
      events[next++] = events[i];
    }
  }
  events.resize(kept.size());
  if (events.size() == all) return;
  faults_.add("events out of the order of time", fmt::format("{} us", *first_wrong),
              static_cast<std::int64_t>(all - events.size()));
}

std::vector<std::pair<std::string, Faults::Fault>> EventStream::faults() const {
  std::vector<std::pair<std::string, Faults::Fault>> all;
  for (auto [kind, fault] : reader_->faults().all()) {
    if (const auto twice = rehearsed_.find(kind); twice != rehearsed_.end()) fault.count -= twice->second;
    if (fault.count > 0) all.emplace_back(kind, fault);
  }
  all.insert(all.end(), faults_.all().begin(), faults_.all().end());
  return all;
}

}  // namespace evbench
