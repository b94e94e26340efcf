#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/events/event_feed.hpp"
#include "core/plugin/delayed_tracks.hpp"
#include "core/plugin/frontend.hpp"

namespace evbench {

/// Throws InputError where a recording has no events in the source's time range: it is another one's, or is misread. A
/// simulated camera may see nothing. Reads up to the first event; `place` is the front-end's, for messages.
void expect_events(const Source& source, const std::string& place);

/// A front-end that goes through its source's events: what those have in common that do. Events come in pieces; at
/// every tick, 5 ms of data time apart however the run exchanges, and at the end of the time range, it looks after what
/// it tracks. Where a recording ends before the time range does, so do the data; one without any event in it is an
/// InputError. Observations may come late and out of order: they are told once none before them can come.
class EventFrontEnd : public FrontEnd {
 public:
  bool advance(const Horizon& horizon, TrackBatch& batch) final;
  double waited() const final { return feed_.seconds(); }
  std::optional<double> data_end() const final;
  std::vector<std::string> remarks() const final;

 protected:
  /// `name`: the front-end's, for messages. Throws InputError for a source without events.
  EventFrontEnd(const FrontEndContext& context, const std::string& name);

  /// The next events, in time order.
  virtual void take(std::span<const Event> events) = 0;

  /// All events up to the clock have been taken, and it is time for a tick.
  virtual void look() = 0;

  /// [s] All observations up to here have been made.
  virtual double complete() const = 0;

  /// What is to be remarked of the tracks.
  virtual std::vector<std::string> counts() const = 0;

  Camera camera_;
  TimeRange range_;
  DelayedTracks told_;
  double clock_;  ///< [s] all events up to here have been taken; while some are, those before them

 private:
  void follow(double t);
  bool is_over() const { return clock_ >= range_.to || (feed_.ended() && !silence_is_known_); }

  const Source& source_;
  std::string place_;
  EventFeed feed_;
  bool silence_is_known_;
  std::int64_t ticks_ = 0;
  std::int64_t events_ = 0;  ///< taken
};

}  // namespace evbench
