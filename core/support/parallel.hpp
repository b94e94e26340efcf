#pragma once

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace evbench {

/// How many threads may run at a time: one a processor, unless a tbb::global_control says otherwise.
inline int processors() {
  return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

/// So many threads, 0: one a processor, and never more than that.
inline int at_most_processors(int threads) { return threads > 0 ? std::min(threads, processors()) : processors(); }

/// Calls work(i) once for each i in [0, count), on up to `threads` threads (0: processors(), and never more), in no
/// particular order. `work` must not throw, and what it computes must not depend on the order. One thread allocates
/// nothing. The threads wait for more when it is done: a program that forks must not have called it before.
template <class Work>
void parallel_for(int threads, int count, const Work& work) {
  if (threads != 1) threads = std::min(at_most_processors(threads), count);
  if (threads <= 1) {
    for (int i = 0; i < count; ++i) work(i);
    return;
  }
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_for(0, count, work); });
}

}  // namespace evbench
