// How the incremental engine's time per update scales.
//   engine_scaling [--quick] [landmarks] [life] [rate] [history] [again]
// One row a problem: time per update, how far updates reach, linearisation, and the floating-point operations of the
// updates compared with dense Cholesky factorisations as large as the root. Without names all sweeps; --quick: 10 s
// instead of 30 s of data, short histories.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/micro/track_problem.hpp"
#include "core/smoother/engine/dense_kernels.hpp"
#include "core/smoother/factors.hpp"
#include "core/smoother/problem_solver.hpp"
#include "eval/quantile.hpp"

namespace {

using namespace evbench;
using smoother::FactorGraph;

constexpr double kRowsOfStates = 24.0;

double median_seconds(int repetitions, const std::function<void()>& call) {
  std::vector<double> seconds;
  for (int i = 0; i < repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    call();
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return quantile_of(seconds, 0.5);
}

/// Additions and multiplications, counted from the sizes of what updates did.
class Operations {
 public:
  explicit Operations(const FactorGraph& graph) : live_(graph.states.size(), 0.0), ended_(live_) {
    for (const auto& landmark : graph.landmarks) {
      if (landmark.intervals.empty()) continue;
      const auto first = static_cast<std::size_t>(landmark.intervals.front());
      const auto last = static_cast<std::size_t>(landmark.intervals.back());
      for (std::size_t k = first; k <= last; ++k) ++live_[k];
      ++ended_[last];
    }
  }

  double root_rows() const { return 12.0 + 3.0 * quantile_of(live_, 0.5); }

  /// Of the update with state k: stages by their rank updates, the root's factor, back-substitution, linearisation.
  double of(std::size_t k, const smoother::UpdateSummary& update) const {
    constexpr double kObservation = 1050.0;  // one in observation_sums.hpp
    const auto first = static_cast<std::size_t>(std::max(update.first_stage, 0));
    double stages = 0.0, pairs = 0.0;
    for (std::size_t i = first; i <= k; ++i) {
      const double rows = kRowsOfStates + 3.0 * live_[i];
      stages += rows * rows * pivots(i);
      pairs += rows * pivots(i);
    }
    const double count = static_cast<double>(k + 1 - first);
    const double root = 12.0 + 3.0 * live_[k];
    return stages * update.stages / count + 2.0 * pairs * update.solved_back / count + root * root * root / 3.0 +
           kObservation * update.linearised;
  }

 private:
  double pivots(std::size_t k) const { return 12.0 + 3.0 * ended_[k]; }

  std::vector<double> live_, ended_;  ///< landmarks, by interval
};

/// GFlop/s of Eigen's and of the engine's dense Cholesky factorisation.
std::array<double, 2> cholesky_gflops(double rows) {
  const int n = smoother::padded(static_cast<int>(rows));
  const Eigen::MatrixXd G = Eigen::MatrixXd::Constant(n, n, 0.1);
  const Eigen::MatrixXd H = G + n * Eigen::MatrixXd::Identity(n, n);
  Eigen::LLT<Eigen::MatrixXd> llt(n);
  Eigen::MatrixXd L = H;
  const double eigen = median_seconds(50, [&] { llt.compute(H); });
  const double own = median_seconds(50, [&] {
    L = H;
    smoother::cholesky_blocked(L.data(), n, n, 0.0);
  });
  const double giga = 1e-9 * n * n * n / 3.0;
  return {giga / eigen, giga / own};
}

double million_observations_linearised_a_second(const FactorGraph& graph) {
  smoother::IntervalLinearisation linear;
  const double seconds = median_seconds(5, [&] {
    for (int k = 1; k < static_cast<int>(graph.states.size()); ++k) linearise_interval(graph, k, linear);
  });
  return 1e-6 * graph.observation_count() / seconds;
}

void measure(const std::string& name, const TrackProblemOptions& options) {
  const Problem problem = make_track_problem(options);
  const smoother::SolveResult result = smoother::solve_problem(problem, {});
  const Operations operations(result.graph);
  std::vector<double> stages, solved_back;
  double flops = 0.0;
  for (std::size_t k = 0; k < result.updates.size(); ++k) {
    stages.push_back(result.updates[k].stages);
    solved_back.push_back(result.updates[k].solved_back);
    flops += operations.of(k, result.updates[k]);
  }
  const auto tenth = static_cast<std::ptrdiff_t>(result.step_ms.size() / 10);
  const auto median_of = [&](auto begin) { return quantile_of(std::vector<double>(begin, begin + tenth), 0.5); };
  // The first tenth is still filling up.
  const double growth = median_of(result.step_ms.end() - tenth) / median_of(result.step_ms.begin() + tenth);
  const auto [eigen, own] = cholesky_gflops(operations.root_rows());
  const double gflops = 1e-9 * flops / result.total_s;
  fmt::print(
      "| {:<24} | {:6} | {:8} | {:8.2f} | {:7.2f} | {:7.2f} | {:7.2f} | {:4.2f} | {:5.0f} | {:5.0f} | {:5.1f} | "
      "{:5.1f} | "
      "{:5.1f} | {:5.1f} | {:3.0f} % |\n",
      name, result.step_ms.size(), problem.observations.size(), result.total_s, quantile_of(result.step_ms, 0.5),
      quantile_of(result.step_ms, 0.99), quantile_of(result.step_ms, 1.0), growth, quantile_of(stages, 0.5),
      quantile_of(solved_back, 0.5), million_observations_linearised_a_second(result.graph), gflops, eigen, own,
      100.0 * gflops / eigen);
  std::fflush(stdout);
}

struct Sweep {
  std::string_view name;
  std::function<void(const TrackProblemOptions& base, bool quick)> run;
};

const std::array<Sweep, 5> kSweeps = {{
    {"landmarks",
     [](TrackProblemOptions o, bool) {
       for (const int tracks : {30, 60, 100, 200}) {
         o.tracks = tracks;
         measure(fmt::format("{} landmarks", tracks), o);
       }
     }},
    {"life",
     [](TrackProblemOptions o, bool) {
       for (const auto& [shortest, longest] : {std::pair(0.5, 2.0), std::pair(2.0, 5.0), std::pair(10.0, 10.0)}) {
         o.shortest = shortest;
         o.longest = longest;
         measure(fmt::format("tracks of {} to {} s", shortest, longest), o);
       }
     }},
    {"rate",
     [](TrackProblemOptions o, bool) {
       for (const double rate : {20.0, 50.0, 100.0}) {
         o.state_rate = rate;
         measure(fmt::format("{} states/s", rate), o);
       }
     }},
    {"history",
     [](TrackProblemOptions o, bool quick) {
       for (const double duration : {30.0, 120.0, 300.0}) {
         o.duration = quick ? duration / 5.0 : duration;
         measure(fmt::format("history of {} s", o.duration), o);
       }
     }},
    {"again",
     [](TrackProblemOptions o, bool) {
       for (const double again : {0.0, 0.3}) {
         o.again = again;
         measure(fmt::format("{:.0f} % seen again", 100.0 * again), o);
       }
     }},
}};

int usage() {
  fmt::print(stderr, "usage: engine_scaling [--quick] [landmarks] [life] [rate] [history] [again]\n");
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string_view> names(argv + 1, argv + argc);
  const bool quick = std::erase(names, "--quick") > 0;
  for (const auto name : names) {
    if (std::ranges::find(kSweeps, name, &Sweep::name) == kSweeps.end()) return usage();
  }
  TrackProblemOptions base;
  if (quick) base.duration = 10.0;
  fmt::print(
      "| problem | updates | observations | total s | median ms | p99 ms | max ms | last/second tenth | stages | "
      "solved "
      "back | linearised M/s | GFlop/s | Eigen LLT | own Cholesky | share of Eigen |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const Sweep& sweep : kSweeps) {
    if (names.empty() || std::ranges::find(names, sweep.name) != names.end()) sweep.run(base, quick);
  }
}
