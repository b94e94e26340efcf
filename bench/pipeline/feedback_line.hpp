#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <vector>

#include "core/plugin/exchange.hpp"

namespace evbench {

/// Delivers feedback from the back-end to the front-end, each in its own thread or both in one. Feedback known at t is
/// delivered exactly when the front-end has reached t + latency in data time, however fast either thread is: this makes
/// a run reproducible. Free-running, it is delivered as soon as it is available.
class FeedbackLine {
 public:
  FeedbackLine(double latency, bool free) : latency_(latency), free_(free) {}

  /// The front-end has sent a batch that was known at t [s]: an answer will follow.
  void expect(double t);

  /// The back-end's answer to the oldest batch that has none.
  void answer(Feedback feedback);

  /// The feedback that is due at `now` [s]. Waits until the back-end has answered all batches that are due.
  std::vector<Feedback> due(double now);

  /// No more answers will come: due() no longer waits.
  void close();

 private:
  bool is_due(double t, double now) const { return t + latency_ <= now + 1e-9; }  // tolerance for rounding

  double latency_;
  bool free_;
  std::mutex mutex_;
  std::condition_variable answered_;
  struct Answer {
    double t;  ///< [s] when its batch was known
    Feedback feedback;
  };
  std::deque<double> expected_;  ///< [s], of batches without an answer
  std::deque<Answer> answers_;
  bool closed_ = false;
};

}  // namespace evbench
