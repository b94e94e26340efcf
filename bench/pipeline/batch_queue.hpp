#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>

#include "core/plugin/exchange.hpp"

namespace evbench {

/// Bounded queue of batches between the front-end's thread and the back-end's. The bound limits how far the front-end
/// may be ahead.
class BatchQueue {
 public:
  explicit BatchQueue(std::size_t capacity) : capacity_(capacity) {}

  /// Waits while the queue is full. False if the queue was closed.
  bool push(TrackBatch batch);

  /// Marks the end of the batches. With an error, pop() throws it after the last batch.
  void finish(std::exception_ptr error = nullptr);

  /// Waits for the next batch. None at the end.
  std::optional<TrackBatch> pop();

  /// Called by the consumer when it stops: push() returns false from then on.
  void close();

 private:
  std::size_t capacity_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<TrackBatch> batches_;
  std::exception_ptr error_;
  bool finished_ = false, closed_ = false;
};

}  // namespace evbench
