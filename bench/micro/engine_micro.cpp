// Micro-benchmarks of the incremental engine: linearisation and cost, dense kernels, per-observation updates.
//   engine_micro PROBLEM
// Prints the median of repeated runs of each.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "core/smoother/engine/dense_kernels.hpp"
#include "core/smoother/factors.hpp"
#include "core/smoother/problem_graph.hpp"
#include "core/smoother/smoother.hpp"
#include "core/support/index.hpp"
#include "core/support/seconds_since.hpp"

namespace {

using namespace evbench;
using namespace evbench::smoother;

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

/// With the loss that most runs have.
void observations(FactorGraph graph) {
  graph.loss = RobustLoss(RobustLoss::Kind::cauchy, 2.0);
  const double count = graph.observation_count();
  const auto print = [&](const char* what, double seconds) {
    fmt::print("{}: {:.1f} ns an observation, {:.1f} million observations/s\n", what, 1e9 * seconds / count,
               1e-6 * count / seconds);
  };
  IntervalLinearisation linear;
  print("linearisation", median_seconds(20, [&] {
          for (int k = 1; k < static_cast<int>(graph.states.size()); ++k) linearise_interval(graph, k, linear);
        }));
  double cost = 0.0;
  print("cost", median_seconds(20, [&] { cost += evaluate(graph).total(); }));
  if (!std::isfinite(cost)) fmt::print("the cost is not finite\n");
}

/// A kernel of the engine compared with Eigen's, on the same data, in turns.
template <class Own, class ByEigen>
void compare(const char* name, int n, int p, double flops, Own own, ByEigen by_eigen) {
  std::vector<double> ratios, seconds;
  for (int i = 0; i < 9; ++i) {
    seconds.push_back(median_seconds(100, own));
    ratios.push_back(median_seconds(100, by_eigen) / seconds.back());
  }
  std::ranges::sort(ratios);
  std::ranges::sort(seconds);
  fmt::print("{:28} {:4} x {:2}: {:7.2f} us, {:5.1f} GFlop/s, {:.2f} times as fast as Eigen\n", name, n, p,
             1e6 * seconds[4], 1e-9 * flops / seconds[4], ratios[4]);
}

void kernels(int landmarks) {
  using Eigen::MatrixXd, Eigen::Lower;
  const int n = padded(24 + 3 * landmarks), p = 20;
  const double N = n, P = p;
  MatrixXd C = MatrixXd::Constant(n, n, 0.1);
  const MatrixXd A = MatrixXd::Constant(n, p, 1e-6), start = A;
  const MatrixXd L = MatrixXd::Identity(p, p) + MatrixXd::Constant(p, p, 0.01);
  compare(
      "rank update", n, p, N * N * P, [&] { subtract_outer_product(C.data(), n, A.data(), n, n, p); },
      [&] { C.selfadjointView<Lower>().rankUpdate(A, -1.0); });
  MatrixXd X = start;
  compare(
      "triangular solve, panel", n, p, N * P * P,
      [&] { X = start, solve_right_transposed(X.data(), n, n, L.data(), p, p); },
      [&] {
        X = start;
        L.triangularView<Lower>().transpose().solveInPlace<Eigen::OnTheRight>(X);
      });
  const MatrixXd spd = MatrixXd::Constant(n, n, 0.1) + 10.0 * N * MatrixXd::Identity(n, n);
  MatrixXd S = spd;
  compare(
      "Cholesky", n, n, N * N * N / 3.0, [&] { S = spd, cholesky_blocked(S.data(), n, n, 0.0); },
      [&] {
        S = spd;
        Eigen::LLT<Eigen::Ref<MatrixXd>> factor(S);
      });
  const MatrixXd small = spd.topLeftCorner(p, p);
  MatrixXd s = small;
  compare(
      "Cholesky of a stage", p, p, P * P * P / 3.0, [&] { s = small, cholesky(s.data(), p, p, 0.0); },
      [&] {
        s = small;
        Eigen::LLT<Eigen::Ref<MatrixXd>> factor(s);
      });
}

void per_observation(const FactorGraph& all) {
  const std::size_t count = std::min<std::size_t>(all.states.size() - 1, 100);
  FactorGraph start = all;
  while (start.states.size() > count) start.remove_newest_state();
  Smoother engine(start, {});
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
        sequence.emplace_back(group.landmark, all.intervals[k].all()[index(i)]);
      }
    }
    std::ranges::stable_sort(sequence, {}, [](const auto& z) { return z.second.t; });
    for (const auto& [landmark, z] : sequence) {
      const auto begin = std::chrono::steady_clock::now();
      if (engine.add_observation_and_update(landmark, z)) microseconds.push_back(1e6 * seconds_since(begin));
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
  observations(graph);
  for (const int landmarks : {20, 60, 100, 200}) kernels(landmarks);
  per_observation(graph);
}
