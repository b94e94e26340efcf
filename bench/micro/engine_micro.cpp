// Micro-benchmarks of the incremental engine: linearisation, dense kernels, per-observation updates.
//   engine_micro PROBLEM
// Prints the median of repeated runs of each.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "backends/gp_map/engine/engine.hpp"
#include "backends/gp_map/problem_graph.hpp"

namespace {

using namespace evbench;
using namespace evbench::gp_map;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

template <class Call>
double median_seconds(int repetitions, Call call) {
  std::vector<double> seconds;
  for (int i = 0; i < repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    call();
    seconds.push_back(seconds_since(start));
  }
  std::ranges::nth_element(seconds, seconds.begin() + repetitions / 2);
  return seconds[seconds.size() / 2];
}

void linearisation(const FactorGraph& graph) {
  IntervalLinearisation linear;
  const double seconds = median_seconds(20, [&] {
    for (int k = 1; k < static_cast<int>(graph.states.size()); ++k) linearise_interval(graph, k, linear);
  });
  const double count = graph.observation_count();
  fmt::print("linearisation: {:.1f} ns an observation, {:.1f} million observations/s\n", 1e9 * seconds / count,
             1e-6 * count / seconds);
}

/// What the machine does in a dense Cholesky factorisation, and the engine's stages beside it.
void kernels(int landmarks) {
  const int n = padded(24 + 3 * landmarks), p = 20, stride = (n / 8 | 1) * 8;
  Buffer C(static_cast<std::size_t>(stride * n), 0.1), A(static_cast<std::size_t>(n * p), 1e-6);
  const double update = median_seconds(200, [&] { subtract_outer_product(C.data(), stride, A.data(), n, n, p); });
  Buffer S(C.size());
  const double factor = median_seconds(100, [&] {
    std::ranges::fill(S, 0.1);
    for (int i = 0; i < n; ++i) S[static_cast<std::size_t>(i * stride + i)] = 10.0 * n;
    cholesky_blocked(S.data(), stride, n, 0.0);
  });
  const double N = n;
  fmt::print(
      "{:4} landmarks: rank-{} update of {} rows {:.1f} us, {:.1f} GFlop/s; Cholesky {:.1f} us, {:.1f} GFlop/s\n",
      landmarks, p, n, 1e6 * update, 1e-9 * N * N * p / update, 1e6 * factor, 1e-9 * N * N * N / 3.0 / factor);
}

void per_observation(const FactorGraph& all) {
  const std::size_t count = std::min<std::size_t>(all.states.size() - 1, 100);
  FactorGraph start = all;
  while (start.states.size() > count) start.remove_newest_state();
  Engine engine(start, {});
  engine.optimise(10, 1e-8);
  std::vector<double> microseconds;
  for (std::size_t k = count; k < std::min(count + 100, all.states.size()); ++k) {
    ControlState next = engine.graph().states.back();
    const double dt = all.states[k].t - next.t;
    next.t += dt;
    next.T = next.T * se3::exp(dt * next.velocity);
    engine.add_state(next);
    std::vector<std::pair<int, Observation>> sequence;
    for (const auto& group : all.intervals[k].groups()) {
      for (int i = group.begin; i < group.end; ++i) {
        sequence.emplace_back(group.landmark, all.intervals[k].all()[static_cast<std::size_t>(i)]);
      }
    }
    std::ranges::stable_sort(sequence, {}, [](const auto& z) { return z.second.t; });
    for (const auto& [landmark, z] : sequence) {
      const auto begin = std::chrono::steady_clock::now();
      if (engine.observe(landmark, z)) microseconds.push_back(1e6 * seconds_since(begin));
    }
    engine.update();
  }
  std::ranges::sort(microseconds);
  const auto at = [&](double q) { return microseconds[static_cast<std::size_t>(q * double(microseconds.size() - 1))]; };
  if (microseconds.empty()) return;
  fmt::print("per-observation mode: {} observations, median {:.1f} us, p99 {:.1f} us, max {:.1f} us\n",
             microseconds.size(), at(0.5), at(0.99), at(1.0));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: engine_micro PROBLEM\n");
    return 2;
  }
  const FactorGraph graph = to_graph(read_problem(argv[1]));
  linearisation(graph);
  for (const int landmarks : {20, 60, 100, 200}) kernels(landmarks);
  per_observation(graph);
}
