#pragma once

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#ifdef __has_feature
#if __has_feature(thread_sanitizer)  // it does not see how TBB's library synchronises, and reports races that are none
#define EVBENCH_PLAIN_THREADS
#include <atomic>
#include <thread>
#include <vector>
#endif
#endif

namespace evbench {

/// Number of threads that may run at a time: one per processor, unless a tbb::global_control limits it.
inline int processors() {
  return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

/// `threads` (0: one per processor), limited to processors().
inline int at_most_processors(int threads) { return threads > 0 ? std::min(threads, processors()) : processors(); }

/// Calls work(i) once for each i in [0, count), on up to `threads` threads (0: processors(), and never more), in any
/// order. `work` must not throw, and its result must not depend on the order. With one thread nothing is allocated. The
/// threads stay alive afterwards: a program must not fork after calling this.
template <class Work>
void parallel_for(int threads, int count, const Work& work) {
  if (threads != 1) threads = std::min(at_most_processors(threads), count);
  if (threads <= 1) {
    for (int i = 0; i < count; ++i) work(i);
    return;
  }
#ifdef EVBENCH_PLAIN_THREADS
  std::atomic<int> next = 0;
  std::vector<std::thread> others;
  const auto run = [&] {
    for (int i = next++; i < count; i = next++) work(i);
  };
  for (int k = 1; k < threads; ++k) others.emplace_back(run);
  run();
  for (std::thread& other : others) other.join();
#else
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_for(0, count, work); });
#endif
}

}  // namespace evbench
