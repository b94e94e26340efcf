#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace evbench {

/// On which this program may run.
inline int processors() { return tbb::this_task_arena::max_concurrency(); }

/// Calls work(i) once for each i in [0, count), on up to `threads` threads (0: one a processor, and never more), in no
/// particular order. `work` must not throw, and what it computes must not depend on the order. One thread allocates
/// nothing.
template <class Work>
void parallel_for(int threads, int count, const Work& work) {
  threads = std::min({threads > 0 ? threads : processors(), processors(), count});
  if (threads < 2) {
    for (int i = 0; i < count; ++i) work(i);
    return;
  }
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_for(0, count, work); });
}

}  // namespace evbench
