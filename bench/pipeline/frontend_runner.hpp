#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <vector>

#include "bench/pipeline/batch_stream.hpp"
#include "bench/pipeline/feedback_line.hpp"
#include "bench/pipeline/options.hpp"
#include "bench/pipeline/stopwatch.hpp"
#include "core/plugin/frontend.hpp"

namespace evbench {

/// The front-end half of a run. It makes one batch per exchange, from the beginning of the time range to its end. After
/// the front-end's last observation the batches are empty.
class FrontEndRunner : public BatchStream {
 public:
  FrontEndRunner(FrontEnd& frontend, const Source& source, const PipelineOptions& options, FeedbackLine& feedback);

  /// Delivers the feedback that is due, then advances the front-end. Throws std::runtime_error for a front-end that
  /// breaks its contract (frontend.hpp).
  std::optional<TrackBatch> next() override;

  FrontFacts facts() const override;

  /// As in FrontFacts, of the batches so far. May be called from another thread.
  double data_s() const { return data_s_; }
  double frontend_s() const { return frontend_s_; }

  double spent() const override { return watch_.seconds(); }

 private:
  double seconds() const { return watch_.seconds() - frontend_.waited(); }  ///< [s] processing in the front-end
  TrackBatch exchange();
  double next_time();
  void check(const TrackBatch& batch, double horizon) const;
  void count(TrackBatch& batch);

  FrontEnd& frontend_;
  const Source& source_;
  TimeRange range_;
  const PipelineOptions& options_;
  FeedbackLine& feedback_;
  FeedbackNeeds needs_;
  bool more_ = true;
  double clock_;  ///< [s] the front-end has processed the data up to here
  double until_;  ///< [s] of the last batch
  bool begun_ = false;
  std::int64_t exchanges_ = 0;  ///< whole intervals since the beginning of the range
  std::set<TrackId> live_;
  std::optional<double> first_;  ///< [s] time of the first observation
  std::atomic<double> data_s_ = 0.0, frontend_s_ = 0.0;
  Stopwatch watch_;
  std::vector<Work> work_;
};

}  // namespace evbench
