#include "core/support/parallel.hpp"

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "core/support/index.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;

TEST_CASE("Each work item is done once, with any number of threads") {
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  CHECK(processors() == 4);
  for (const int threads : {0, 1, 3, 100}) {
    for (const int count : {0, 1, 2, 1000}) {
      std::vector<std::atomic<int>> done(index(count));
      parallel_for(threads, count, [&](int i) { ++done[index(i)]; });
      for (const auto& times : done) CHECK(times == 1);
    }
  }
}

TEST_CASE("Threads work at the same time") {
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  std::atomic<int> begun = 0, met = 0;
  parallel_for(2, 2, [&](int) {
    ++begun;
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (begun < 2 && std::chrono::steady_clock::now() < until) std::this_thread::yield();
    if (begun == 2) ++met;
  });
  CHECK(met == 2);
}
