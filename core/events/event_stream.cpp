#include "core/events/event_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <span>

#include "core/events/longest_in_order.hpp"
#include "core/events/sensor_size.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

// So that differences and sums of times can't overflow.
constexpr std::int64_t kLatestStreamTime = std::int64_t{1} << 61;  // [us]

/// Are all in time order, none before `from` or beyond any time, and all within the sensor? It has no branches and the
/// narrowest types, so that it is vectorised: it checks every event.
bool are_fine(std::span<const Event> events, std::int64_t from, int width, int height) {
  const auto last_x = static_cast<std::uint32_t>(width - 1), last_y = static_cast<std::uint32_t>(height - 1);
  std::uint64_t back = events.front().t < from;
  std::uint32_t outside = (last_x - events.front().x) | (last_y - events.front().y);  // in the highest bit
  for (std::size_t i = 1; i < events.size(); ++i) {
    back |= static_cast<std::uint64_t>(events[i].t < events[i - 1].t);
    outside |= (last_x - events[i].x) | (last_y - events[i].y);
  }
  return back == 0 && outside >> 31 == 0 && events.front().t >= -kLatestStreamTime &&
         events.back().t <= kLatestStreamTime;
}

}  // namespace

EventStream::EventStream(std::unique_ptr<EventReader> reader, std::string path, const StreamOptions& options)
    : path_(std::move(path)),
      lenient_(options.read.lenient),
      width_(options.width > 0 ? options.width : 1 << 16),
      height_(options.height > 0 ? options.height : 1 << 16),
      size_assumption_(options.size_assumption),
      reader_(std::move(reader)),
      faults_(path_, options.read.strict) {
  check_sensor_size(path_, info().width, info().height);
  if (options.rebase) find_zero();
  if (options.to) end_ = *options.to + zero_;
  if (options.from) seek(*options.from);
}

/// Finds the time of the first event; returns to the beginning.
void EventStream::find_zero() {
  std::vector<Event> first;
  if (read(first)) zero_ = first.front().t;
  seek_reader(kBeginning);
}

void EventStream::seek(std::int64_t t) {
  from_ = t + zero_;
  seek_reader(from_);
}

void EventStream::seek_reader(std::int64_t t) {
  newest_ = kBeginning;
  good_ = 0;
  ended_ = false;
  ahead_.clear();
  faults_.clear();
  reader_->seek(t);
}

/// The reader's next events; ahead_ has those that follow them.
bool EventStream::next_chunk(std::vector<Event>& events) {
  check_interruption();
  if (ahead_.empty() && !reader_->read(ahead_)) return false;
  std::swap(events, ahead_);
  reader_->read(ahead_);
  return true;
}

bool EventStream::read(std::vector<Event>& events) {
  while (!ended_ && next_chunk(events)) {
    check(events);
    if (!events.empty()) return true;
  }
  events.clear();
  ended_ = true;
  if (lenient_) return false;
  if (const auto loss = large_loss()) throw InputError(*loss);
  return false;
}

std::optional<std::string> EventStream::large_loss() const {
  std::int64_t lost = 0;
  auto kinds = faults();
  std::ranges::stable_sort(kinds, std::ranges::greater(), [](const auto& kind) { return kind.second.count; });
  for (const auto& kind : kinds) lost += kind.second.count;
  const std::int64_t all = good_ + lost;
  if (10 * lost <= all) return std::nullopt;
  const auto& [worst, fault] = kinds.front();
  std::string others;
  for (const auto& [kind, other] : std::span(kinds).subspan(1)) others += fmt::format("; {} {}", other.count, kind);
  return fmt::format(
      "{}: {:.1f} % of the events, {} of {}, have to be left out, most of them as {} (the first: {}){}; expected a "
      "recording with fewer faults, or --lenient (source.lenient in a run's config)",
      path_, 100.0 * static_cast<double>(lost) / static_cast<double>(all), lost, all, worst, fault.first, others);
}

/// Keeps what is in order, in the sensor and in the range, with times of the stream.
void EventStream::check(std::vector<Event>& events) {
  if (events.empty()) return;
  const int width = info().width > 0 ? std::min(info().width, width_) : width_;
  const int height = info().height > 0 ? std::min(info().height, height_) : height_;
  if (events.back().t >= end_ || overlaps_next(events) || !are_fine(events, std::max(newest_, from_), width, height)) {
    leave_out_outside(events, width, height);
    leave_out_disorder(events);
    if (!events.empty()) newest_ = events.back().t;
    good_ += std::ssize(events);
    const auto last = std::ranges::lower_bound(events, end_, {}, &Event::t);
    const auto first = std::ranges::lower_bound(events.begin(), last, from_, {}, &Event::t);  // from may be after end
    ended_ = last != events.end();
    events.erase(last, events.end());
    events.erase(events.begin(), first);
  } else {
    newest_ = events.back().t;
    good_ += std::ssize(events);
  }
  note_extent(events);
  if (zero_ == 0) return;
  for (Event& event : events) event.t -= zero_;
}

bool EventStream::overlaps_next(std::span<const Event> events) const {
  return !ahead_.empty() && !events.empty() && ahead_.front().t < events.back().t;
}

void EventStream::note_extent(std::span<const Event> events) {
  for (const Event& event : events) {
    max_x_ = std::max<int>(max_x_, event.x);
    max_y_ = std::max<int>(max_y_, event.y);
  }
}

// Faults are reported once a chunk: a recording may consist of nothing but faults.

void EventStream::leave_out_outside(std::vector<Event>& events, int width, int height) {
  std::int64_t outside = 0, beyond = 0;
  Event first_outside, first_beyond;
  std::size_t kept = 0;
  for (const Event& event : events) {
    if (event.x >= width || event.y >= height) {
      if (outside++ == 0) first_outside = event;
    } else if (event.t > kLatestStreamTime || event.t < -kLatestStreamTime) {
      if (beyond++ == 0) first_beyond = event;
    } else {
      events[kept++] = event;
    }
  }
  events.resize(kept);
  if (outside > 0 && !size_assumption_.empty() && !lenient_) {
    throw InputError(fmt::format("{}: an event at {} us has the pixel ({}, {}), outside the sensor of {}x{} pixels: {}",
                                 path_, first_outside.t, first_outside.x, first_outside.y, width, height,
                                 size_assumption_));
  }
  if (outside > 0) {
    faults_.add(fmt::format("events outside the sensor of {}x{} pixels", width, height),
                fmt::format("{} us, pixel ({}, {})", first_outside.t, first_outside.x, first_outside.y), outside);
  }
  if (beyond > 0) faults_.add("events beyond any time (2^61 us)", fmt::format("{} us", first_beyond.t), beyond);
}

void EventStream::leave_out_disorder(std::vector<Event>& events) {
  const std::size_t all = events.size();
  std::optional<std::int64_t> first_wrong;
  const auto leave_out = [&](const Event& event) {
    if (!first_wrong) first_wrong = event.t;
    return true;
  };
  const auto too_early = [&](const Event& event) { return event.t < newest_; };
  std::erase_if(events, [&](const Event& event) { return too_early(event) && leave_out(event); });
  // With the events that follow, as the last ones may be the wrong ones.
  const std::size_t count = events.size();
  if (overlaps_next(events)) std::ranges::remove_copy_if(ahead_, std::back_inserter(events), too_early);
  const std::vector<std::uint32_t> kept = longest_in_order(events);
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (next == kept.size() || kept[next] != i) {
      leave_out(events[i]);
    } else {
      events[next++] = events[i];
    }
  }
  events.resize(next);
  if (next == all) return;
  faults_.add("events out of the order of time", fmt::format("{} us", *first_wrong),
              static_cast<std::int64_t>(all - next));
}

std::vector<std::pair<std::string, Faults::Fault>> EventStream::faults() const {
  std::vector<std::pair<std::string, Faults::Fault>> all(reader_->faults().all().begin(),
                                                         reader_->faults().all().end());
  all.insert(all.end(), faults_.all().begin(), faults_.all().end());
  return all;
}

}  // namespace evbench
