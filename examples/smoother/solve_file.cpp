// solve_file PROBLEM: solves a problem file step by step and prints cost and time.
#include <chrono>
#include <cstdio>
#include <evbench/smoother.hpp>
#include <exception>
#include <vector>

using namespace evbench;
using namespace evbench::smoother;

namespace {

void solve(const char* path) {
  const FactorGraph whole = to_graph(read_problem(path));
  Smoother smoother(whole.camera, whole.qc, whole.loss);
  const auto start = std::chrono::steady_clock::now();
  std::vector<int> numbers(whole.landmarks.size(), -1);  // in the smoother: a landmark enters with its first interval
  for (std::size_t k = 0; k < whole.states.size(); ++k) {
    k == 0 ? smoother.add_state(whole.states[0]) : smoother.add_state_at(whole.states[k].t);
    const int state = static_cast<int>(k);
    for (const PosePrior& prior : whole.pose_priors) {
      if (prior.state == state) smoother.add_pose_prior(prior);
    }
    for (const VelocityPrior& prior : whole.velocity_priors) {
      if (prior.state == state) smoother.add_velocity_prior(prior);
    }
    for (const IntervalObservations::Group& group : whole.intervals[k].groups()) {
      const std::size_t j = static_cast<std::size_t>(group.landmark);
      if (numbers[j] < 0) numbers[j] = smoother.add_landmark(whole.landmarks[j].position, whole.landmarks[j].prior);
      for (const Observation& z : whole.intervals[k].of(group)) smoother.add_observation(numbers[j], z);
    }
    smoother.update();
  }
  smoother.update_everything();
  const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
  std::printf("%zu states, %zu landmarks, %d observations: cost %.6g, %.2f ms a step\n", whole.states.size(),
              whole.landmarks.size(), whole.observation_count(), evaluate(smoother.graph()).total(),
              elapsed.count() / static_cast<double>(whole.states.size()));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: solve_file PROBLEM\n"), 2;
  try {
    solve(argv[1]);
  } catch (const std::exception& error) {
    return std::fprintf(stderr, "%s\n", error.what()), 2;
  }
}
