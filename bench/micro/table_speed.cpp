// How long a table of many runs takes: reads a run's folder, writes N copies of its metrics.json and config.json with
// seeds and labels of their own below a folder, finds them, and makes tables of them.
//   table_speed RUN FOLDER [N]
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>

#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "eval/comparison_table.hpp"
#include "eval/find_runs.hpp"
#include "eval/json_file.hpp"
#include "eval/table.hpp"

namespace {

using namespace evbench;
using Clock = std::chrono::steady_clock;

constexpr int kLabels = 10;

/// Seeds times labels, as a sweep has them; each a little worse than the one before, so that there is something to
/// test.
void write_runs(const std::string& run, const std::string& folder, int count) {
  Json metrics = read_json_file(run + "/metrics.json"), config = read_json_file(run + "/config.json");
  const double error = metrics["final"]["ate"]["trans_m"]["rmse"].get<double>();
  for (int i = 0; i < count; ++i) {
    const std::string key = fmt::format("copy-{:05}", i);
    metrics["key"] = key;
    metrics["seed"] = config["seed"] = i / kLabels;
    metrics["label"] = config["backend"]["label"] = fmt::format("method {}", i % kLabels);
    metrics["final"]["ate"]["trans_m"]["rmse"] = error * (1.0 + 0.1 * (i % kLabels) + 1e-3 * (i * 7919 % 101));
    const std::string path = folder + "/" + key;
    std::filesystem::create_directories(path);
    write_file(path + "/metrics.json", dump_json(metrics, 2));
    write_file(path + "/config.json", dump_json(config, 2));
  }
}

template <class Work>
auto timed(const char* what, const Work& work) {
  const auto start = Clock::now();
  const std::clock_t processor = std::clock();
  auto result = work();
  fmt::print("{:<28} {:8.3f} s, {:8.3f} s of processors\n", what,
             std::chrono::duration<double>(Clock::now() - start).count(),
             static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC);
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "table_speed RUN FOLDER [N]: a run's folder, an empty one for copies, how many\n");
    return 2;
  }
  try {
    const std::string folder = argv[2];
    if (!std::filesystem::exists(folder)) write_runs(argv[1], folder, argc > 3 ? std::atoi(argv[3]) : 10'000);
    const auto runs = timed("find and read", [&] { return find_runs(std::vector{folder}); });
    const auto table = [&](const char* what, const TableOptions& options) {
      const std::string text = timed(what, [&] { return make_table(runs, options); });
      fmt::print("{:<28} {:8} bytes\n", "", text.size());
    };
    fmt::print("{} runs\n", runs.size());
    table("a row a run", {});
    table("over seeds", {.over = {"seed"}});
    table("csv", {.format = TableFormat::csv});
    table("long", {.format = TableFormat::long_csv});
    timed("comparison", [&] { return make_comparison_table(runs, {}); });
  } catch (const InputError& error) {
    fmt::print(stderr, "table_speed: {}\n", error.what());
    return 2;
  }
  return 0;
}
