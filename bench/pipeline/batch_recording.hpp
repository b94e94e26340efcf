#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "bench/pipeline/batch_stream.hpp"
#include "bench/pipeline/stopwatch.hpp"

namespace evbench {

/// Records all batches of a front-end that uses no feedback, and its facts. RecordedBatches replays the bytes, so that
/// any number of back-ends get identical batches and the front-end runs once. The bytes have this machine's byte
/// order; the last line is the SHA-256 of all before it.
std::string record_batches(BatchStream& batches);

/// Replays a recording. The facts are those of the recorded front-end: its processing time counts, not that of reading.
class RecordedBatches : public BatchStream {
 public:
  /// Null if there is no such file or it is damaged: the caller then runs the front-end.
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
  std::size_t at_ = 0, end_ = 0;  ///< position of the next batch; end of the batches
  FrontFacts facts_;
  Stopwatch watch_;
};

}  // namespace evbench
