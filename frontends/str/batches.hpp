#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/events/event.hpp"
#include "core/plugin/options.hpp"
#include "frontends/str/registration/registration.hpp"

namespace evbench::str {

/// When a batch ends.
struct BatchOptions {
  double duration = 0.03;
  int events = 0;
  double motion = 0.0;

  void declare(OptionSet& set);
};

/// Divides events into batches. Each batch begins with the last slice of the previous one, so that tracks go on from
/// there; a much shorter batch begins with the end of that slice. Each batch ends after the previous one. Batches
/// follow one another in time, whether there are events or not.
class Batches {
 public:
  /// `from` [µs]: where the first one begins. `slice`: the share that two batches have in common.
  Batches(const BatchOptions& options, double slice, std::int64_t from);

  /// Adds events, in time order, not before those that were added earlier.
  void add(std::span<const Event> events) { events_.insert(events_.end(), events.begin(), events.end()); }

  /// Sets the expected speed of the image [px/s], for batches that end by motion.
  void expect(double speed) { speed_ = speed; }

  /// Adapts the length of the next batch. Where the last one's motion was not found, the next one is half as long, down
  /// to about an eighth of the duration, and then of full length again: motion that is too large for a batch is not for
  /// a part of it. Where it was found, the next one may be twice as long.
  void learn(bool found);

  /// The next batch, if it ends at or before `until` [µs], up to which all events have been added; valid until the
  /// next call of add() or next(). Call until there is none.
  std::optional<Batch> next(std::int64_t until);

 private:
  BatchOptions options_;
  double slice_;
  std::int64_t end_;         ///< [µs] of the last one
  std::int64_t shared_ = 0;  ///< [µs] before that; the next one begins there at the earliest
  double speed_ = 0.0;       ///< [px/s]
  double longest_;           ///< [s] of the next one
  double last_ = 0.0;        ///< [s] how long the last one was
  std::vector<Event> events_;
};

}  // namespace evbench::str
