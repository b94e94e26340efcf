#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>

#include "core/plugin/exchange.hpp"

namespace evbench {

/// Batches on their way from the front-end's thread to the back-end's: a bounded queue, so that the front-end is never
/// more than that ahead.
class BatchQueue {
 public:
  explicit BatchQueue(std::size_t capacity) : capacity_(capacity) {}

  /// Waits for a place. False when nobody takes batches any more.
  bool push(TrackBatch batch);

  /// No more batches; with an error, pop() throws it when it has come to the end.
  void finish(std::exception_ptr error = nullptr);

  /// Waits for the next one. None at the end.
  std::optional<TrackBatch> pop();

  /// Batches are no longer taken.
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
