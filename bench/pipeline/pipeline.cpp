#include "bench/pipeline/pipeline.hpp"

#include <malloc.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "bench/pipeline/backend_runner.hpp"
#include "bench/pipeline/batch_queue.hpp"
#include "bench/pipeline/feedback_line.hpp"
#include "bench/pipeline/frontend_runner.hpp"
#include "bench/pipeline/pace.hpp"
#include "core/support/peak_memory.hpp"

namespace evbench {
namespace {

/// Restarts peak_memory_mib().
void reset_peak_memory() {
  ::malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

/// The back-end half of one exchange.
void exchange(TrackBatch batch, const FeedbackNeeds& needs, BackEndRunner& back, FeedbackLine& feedback,
              const Progress& progress) {
  back.take(std::move(batch));
  if (needs.any) feedback.answer(back.feedback(needs));
  if (progress) progress(back.progress());
}

void run_sequential(BatchStream& front, BackEndRunner& back, const FeedbackNeeds& needs, FeedbackLine& feedback,
                    const Progress& progress) {
  while (std::optional<TrackBatch> batch = front.next()) exchange(std::move(*batch), needs, back, feedback, progress);
}

/// Runs the front-end in a second thread. Returns how long the back-end's thread waited for it [s].
double run_concurrent(BatchStream& front, BackEndRunner& back, const FeedbackNeeds& needs, FeedbackLine& feedback,
                      std::size_t capacity, const Progress& progress) {
  BatchQueue queue(capacity);
  std::jthread thread([&] {
    try {
      while (std::optional<TrackBatch> batch = front.next()) {
        if (!queue.push(std::move(*batch))) return;
      }
      queue.finish();
    } catch (...) {
      queue.finish(std::current_exception());
    }
  });
  Stopwatch waiting;
  try {
    while (std::optional<TrackBatch> batch = waiting.time([&] { return queue.pop(); })) {
      exchange(std::move(*batch), needs, back, feedback, progress);
    }
  } catch (...) {  // the front-end's thread may wait for a place in the queue or for an answer
    queue.close();
    feedback.close();
    throw;
  }
  return waiting.seconds();
}

/// A stream whose tracks are kept.
class KeptTracks : public BatchStream {
 public:
  explicit KeptTracks(BatchStream& stream) : stream_(stream) {}

  std::optional<TrackBatch> next() override {
    std::optional<TrackBatch> batch = stream_.next();
    if (!batch) return batch;
    tracks.observations.insert(tracks.observations.end(), batch->observations.begin(), batch->observations.end());
    tracks.ended.insert(tracks.ended.end(), batch->ended.begin(), batch->ended.end());
    return batch;
  }
  FrontFacts facts() const override { return stream_.facts(); }
  double spent() const override { return stream_.spent(); }

  TrackBatch tracks;

 private:
  BatchStream& stream_;
};

/// `feedback` is used only if the front-end needs any.
RunResult run(const Source& source, BatchStream& stream, const FeedbackNeeds& needs, FeedbackLine& feedback,
              const MakeBackEnd& make_backend, BackEndContext context, const PipelineOptions& options,
              double trajectory_rate, const Progress& progress, bool keep_tracks) {
  RunResult result;
  KeptTracks kept(stream);
  BatchStream& front = keep_tracks ? kept : stream;
  context.log = [&](const std::string& line) { result.log.push_back(line); };
  context.event = [&](const RunEvent& event) {
    result.log.push_back(fmt::format("{:.3f} s: {}", event.t, event.text));
    result.events.push_back(event);
  };
  BackEndRunner back(make_backend, std::move(context), source.camera(), source.time_range(), options);
  Stopwatch total;
  total.time([&] {
    if (options.mode == "sequential") {
      run_sequential(front, back, needs, feedback, progress);
    } else {
      const auto capacity = static_cast<std::size_t>(options.queue);
      result.times.waiting = run_concurrent(front, back, needs, feedback, capacity, progress);
    }
    back.finish(trajectory_rate, result);
  });
  const FrontFacts facts = front.facts();
  const bool sequential = options.mode == "sequential";
  const double not_harness = sequential ? front.spent() : result.times.waiting;
  result.times.source = facts.source_s;
  result.times.frontend = facts.frontend_s;
  for (const Work& of_batch : facts.work) result.times.frontend_batches.push_back(of_batch.seconds);
  result.times.slowest_5s = slowest_pace({facts.work, back.work()}, source.time_range().from, 5.0);
  result.times.backend = back.seconds();
  result.times.harness = std::max(0.0, total.seconds() - back.seconds() - not_harness);
  result.times.total = total.seconds() + (sequential ? facts.source_s + facts.frontend_s - front.spent() : 0.0);
  result.data_s = facts.data_s;
  result.peak_rss_mib = peak_memory_mib();
  result.log.insert(result.log.end(), facts.log.begin(), facts.log.end());
  if (keep_tracks) result.tracks = std::move(kept.tracks);
  if (options.mode == "free") result.log.push_back("pipeline: mode free is not reproducible");
  return result;
}

}  // namespace

RunResult run_pipeline(const Source& source, FrontEnd& frontend, const MakeBackEnd& make_backend,
                       BackEndContext context, const PipelineOptions& options, double trajectory_rate,
                       const Progress& progress, bool keep_tracks) {
  reset_peak_memory();
  FeedbackLine feedback(options.latency, options.mode == "free");
  FrontEndRunner front(frontend, source, options, feedback);
  const Progress report = [&](RunProgress now) {
    now.realtime_factor = realtime_factor(front.data_s(), front.frontend_s() + now.backend_s);
    progress(now);
  };
  return run(source, front, frontend.needs(), feedback, make_backend, std::move(context), options, trajectory_rate,
             progress ? report : Progress(), keep_tracks);
}

RunResult run_pipeline(const Source& source, BatchStream& batches, const MakeBackEnd& make_backend,
                       BackEndContext context, const PipelineOptions& options, double trajectory_rate,
                       const Progress& progress, bool keep_tracks) {
  reset_peak_memory();
  FeedbackLine unused(options.latency, false);
  return run(source, batches, {}, unused, make_backend, std::move(context), options, trajectory_rate, progress,
             keep_tracks);
}

}  // namespace evbench
