#include "bench/pipeline/pipeline.hpp"

#include <malloc.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "bench/pipeline/back_side.hpp"
#include "bench/pipeline/batch_queue.hpp"
#include "bench/pipeline/feedback_line.hpp"
#include "bench/pipeline/front_side.hpp"
#include "core/support/peak_memory.hpp"

namespace evbench {
namespace {

/// peak_memory_mib() counts from here on.
void reset_peak_memory() {
  ::malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

/// One exchange on the back-end's side.
void exchange(TrackBatch batch, const FeedbackNeeds& needs, BackSide& back, FeedbackLine& feedback,
              const Progress& progress) {
  back.take(std::move(batch));
  if (needs.any) feedback.answer(back.feedback(needs));
  if (progress) progress(back.progress());
}

void run_sequential(FrontSide& front, BackSide& back, const FeedbackNeeds& needs, FeedbackLine& feedback,
                    const Progress& progress) {
  while (std::optional<TrackBatch> batch = front.next()) exchange(std::move(*batch), needs, back, feedback, progress);
}

/// The front-end in a thread of its own. Returns how long the back-end's waited for it [s].
double run_concurrent(FrontSide& front, BackSide& back, const FeedbackNeeds& needs, FeedbackLine& feedback,
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
  } catch (...) {  // the front-end's thread is waiting for a place or an answer that will not come
    queue.close();
    feedback.close();
    throw;
  }
  return waiting.seconds();
}

}  // namespace

RunResult run_pipeline(const Source& source, FrontEnd& frontend, const MakeBackEnd& make_backend,
                       BackEndContext context, const PipelineOptions& options, double trajectory_rate,
                       const Progress& progress, bool keep_tracks) {
  RunResult result;
  reset_peak_memory();
  context.log = [&](const std::string& line) { result.log.push_back(line); };
  const Source::TimeRange range = source.time_range();
  const FeedbackNeeds needs = frontend.needs();
  FeedbackLine feedback(options.latency, options.mode == "free");
  FrontSide front(frontend, range, options, feedback, keep_tracks ? &result.tracks : nullptr);
  BackSide back(make_backend, std::move(context), source.camera(), range, options);
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
  result.times.source = frontend.waited();
  result.times.frontend = front.seconds();
  result.times.frontend_batches = front.batch_seconds();
  result.times.backend = back.seconds();
  result.times.total = total.seconds();
  const double elsewhere = options.mode == "sequential" ? front.seconds() + frontend.waited() : result.times.waiting;
  result.times.harness = std::max(0.0, total.seconds() - back.seconds() - elsewhere);
  result.data_s = front.data_s();
  result.peak_rss_mib = peak_memory_mib();
  for (const std::string& remark : source.remarks()) result.log.push_back("source: " + remark);
  for (const std::string& remark : frontend.remarks()) result.log.push_back("frontend: " + remark);
  if (options.mode == "free") result.log.push_back("pipeline: free-running, which is not reproducible");
  return result;
}

}  // namespace evbench
