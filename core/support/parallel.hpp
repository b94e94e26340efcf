#pragma once

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace evbench {

/// Calls work(i) once for each i in [0, count), on `threads` threads (0: one a processor), in no particular order.
/// `work` must not throw, and what it computes must not depend on the order.
template <class Work>
void parallel_for(int threads, int count, const Work& work) {
  if (threads <= 0) threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  std::atomic<int> next = 0;
  const auto loop = [&] {
    for (int i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::jthread> helpers;
  for (int i = 1; i < std::min(threads, count); ++i) helpers.emplace_back(loop);
  loop();
}

}  // namespace evbench
