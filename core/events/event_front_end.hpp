#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/events/event_feed.hpp"
#include "core/plugin/delayed_tracks.hpp"
#include "core/plugin/frontend.hpp"

namespace evbench {

/// Throws InputError if a recording has no events in the source's time range: it is the wrong recording, or is misread.
/// A simulated camera may see nothing. Reads up to the first event; `place` is the front-end's, for messages.
void expect_events(const SensorData& source, const std::string& place);

/// Base of the front-ends that process their source's events. Events come in parts. At every tick, 5 ms of data time
/// apart whatever the exchange interval of the run, and at the end of the time range, on_tick() maintains the tracks.
/// Where a recording ends before the time range, so do the data; a recording without any event in the range is an
/// InputError. Observations may come late and out of order: they are released once none before them can come.
class EventFrontEnd : public FrontEnd {
 public:
  bool advance(const Horizon& horizon, TrackBatch& batch) final;
  double waited() const final { return feed_.seconds(); }
  std::optional<double> data_end() const final;
  std::vector<std::string> remarks() const final;

 protected:
  /// `name`: the front-end's, for messages. Throws InputError for a source without events.
  EventFrontEnd(const FrontEndContext& context, const std::string& name);

  static constexpr double kTick = 0.005;  ///< [s] of data time between two calls of on_tick()

  /// The next events, in time order.
  virtual void take(std::span<const Event> events) = 0;

  /// Called at every tick, when all events up to clock_ have been taken.
  virtual void on_tick() = 0;

  /// [s] Time up to which all observations have been made.
  virtual double complete() const = 0;

  /// Remarks on the tracks, for the run's log.
  virtual std::vector<std::string> counts() const = 0;

  Camera camera_;
  TimeRange range_;
  DelayedTracks delayed_;
  double clock_;  ///< [s] all events up to here have been taken; take() sees the value before its events

 private:
  void follow(double t);
  bool is_over() const { return clock_ >= range_.to || (feed_.ended() && !silence_is_known_); }

  const SensorData& source_;
  std::string place_;
  EventFeed feed_;
  bool silence_is_known_;
  std::int64_t ticks_ = 0;
  std::int64_t events_ = 0;  ///< taken
};

}  // namespace evbench
