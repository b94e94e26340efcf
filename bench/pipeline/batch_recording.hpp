#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "bench/pipeline/batch_stream.hpp"
#include "bench/pipeline/stopwatch.hpp"

namespace evbench {

/// All that a front-end gives which takes no feedback, and what is known of its side at the end: bytes from which
/// RecordedBatches gives it once more, so that any number of back-ends get the identical batches of one front-end's
/// work. Of this machine's byte order; the last line is the SHA-256 of what stands before it.
std::string record_batches(BatchStream& batches);

/// A recording, played. Facts are those of the front-end that was recorded: its time counts, not that of reading.
class RecordedBatches : public BatchStream {
 public:
  /// Nothing where there is no such file, or it is damaged: who needs the batches then makes them.
  static std::unique_ptr<RecordedBatches> open(const std::string& path);

  std::optional<TrackBatch> next() override;
  FrontFacts facts() const override { return facts_; }
  double spent() const override { return watch_.seconds(); }

 private:
  explicit RecordedBatches(std::string bytes);
  template <class Value>
  Value take();
  TrackBatch take_batch();

  std::string bytes_;
  std::size_t at_ = 0, end_ = 0;  ///< of what is to be played
  FrontFacts facts_;
  Stopwatch watch_;
};

}  // namespace evbench
