#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <vector>

#include "core/plugin/exchange.hpp"

namespace evbench {

/// Carries feedback from the back-end to the front-end, each in its own thread or both in one. What was known at t is
/// handed over when the front-end has reached t + latency in data time, neither sooner nor later, however fast either
/// thread is: that makes a run reproducible. Free-running, it is handed over as soon as it is there.
class FeedbackLine {
 public:
  FeedbackLine(double latency, bool free) : latency_(latency), free_(free) {}

  /// The front-end has sent a batch that was known at t [s]: an answer is to come.
  void expect(double t);

  /// The back-end's answer to the oldest batch that has none.
  void answer(Feedback feedback);

  /// What the front-end gets before it goes on from `now`; waits until the back-end has answered what is due by then.
  std::vector<Feedback> due(double now);

  /// Nothing more will be answered: nobody waits any longer.
  void close();

 private:
  bool is_due(double t, double now) const { return t + latency_ <= now + 1e-9; }  // but for rounding

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
