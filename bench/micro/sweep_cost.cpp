// Overhead of a sweep: sweep_cost [RUNS [PROCESSES]], by default 1,000 on two. Each run is of a back-end
// that does nothing on 0.1 s of simulated tracks, in a process of its own, with all files of a run's folder, below a
// temporary folder ($TMPDIR). Prints the times of planning (keys), of the sweep, of the sweep once more when all is
// complete, and of the runs alone, in this process and without a folder.

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "bench/runner.hpp"
#include "bench/sweep/local_executor.hpp"
#include "core/plugin/registration.hpp"

using namespace evbench;

namespace {

class Nothing : public BackEnd {
 public:
  struct Options {
    void declare(OptionSet&) {}
  };
  Nothing(const Options&, const BackEndContext&) {}
  void advance(const UndistortedBatch&) override {}
  BackEndFeedback feedback(const FeedbackNeeds&) override { return {}; }
  void finish() override {}
  Status status() const override { return {RunState::failed, "no estimate is made", 0.0, {}}; }
  PoseTrajectory trajectory() const override { return {}; }
  std::vector<Landmark> map() const override { return {}; }
};

const Registration<BackEnd, Nothing> registration("nothing", "does nothing");

template <class Work>
double seconds(Work work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void tell(const char* what, double seconds, std::size_t runs) {
  fmt::print("{:<34} {:8.2f} s {:8.2f} ms a run\n", what, seconds, 1e3 * seconds / static_cast<double>(runs));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string count = argc > 1 ? argv[1] : "1000";
  const int processes = argc > 2 ? std::atoi(argv[2]) : 2;
  std::string folder = (std::filesystem::temp_directory_path() / "evbench-sweep-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return 1;
  const std::string config = folder + "/c.json";
  std::ofstream(config) << R"({"name": "trivial", "source": {"type": "simulation", "duration": 0.1},
                               "frontend": {"type": "oracle"}, "backend": {"type": "nothing"}})";
  Plugins plugins = registered_plugins();
  SweepPlan plan;
  const double planning =
      seconds([&] { plan = plan_sweep(read_sweep(config, {}, {"seed=1.." + count}, plugins), plugins); });
  const std::size_t runs = plan.runs.size();
  const ExecutorOptions options{folder + "/results", processes, {60.0, 4096.0}, false};
  const auto sweep = [&] { do_runs(plan.runs, plugins, options, [](const SweepProgress&) {}); };
  const double first = seconds(sweep), again = seconds(sweep);
  const double alone = seconds([&] {
    for (const PlannedRun& run : plan.runs) {
      const std::unique_ptr<Source> source = make_source(run.config.job, plugins);
      execute(run.config.job, *source, plugins, {});
    }
  });
  tell("planning", planning, runs);
  tell(fmt::format("the sweep, {} at a time", processes).c_str(), first, runs);
  tell("again, when all is complete", again, runs);
  tell("the runs alone", alone, runs);
  std::filesystem::remove_all(folder);
  return 0;
}
