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

/// Events in batches, of which each begins with the last slice of the one before, or with the end of that where it is
/// much shorter: what was found there is where the next one goes on. Each ends after the one before. Batches follow one
/// another in time, whether there are events or not.
class Batches {
 public:
  /// `from` [µs]: where the first one begins. `slice`: the share that two batches have in common.
  Batches(const BatchOptions& options, double slice, std::int64_t from);

  /// The next ones, in time order, not before those that were added.
  void add(std::span<const Event> events) { events_.insert(events_.end(), events.begin(), events.end()); }

  /// The image moves at this speed [px/s], for batches that end by motion.
  void expect(double speed) { speed_ = speed; }

  /// Whether the last one's motion was found. Where it was not, the next one is half as long, down to about an eighth
  /// of the duration, then as long as ever; where it was, the next one may be twice as long: what is too much motion
  /// for a batch is not for a part of it.
  void learn(bool found);

  /// The next batch, if it ends at or before `until` [µs], up to which all events have been added; valid until the
  /// next call of add() or next(). Call until there is none.
  std::optional<Batch> next(std::int64_t until);

 private:
  BatchOptions options_;
  double slice_;
  std::int64_t end_;         ///< [µs] of the last one
  std::int64_t shared_ = 0;  ///< [µs] before that, from where on the next one may begin
  double speed_ = 0.0;       ///< [px/s]
  double longest_;           ///< [s] of the next one
  double last_ = 0.0;        ///< [s] how long the last one was
  std::vector<Event> events_;
};

}  // namespace evbench::str
