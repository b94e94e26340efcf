#pragma once

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

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
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_for(0, count, work); });
}

}  // namespace evbench
