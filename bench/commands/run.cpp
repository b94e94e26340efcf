#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/commands/commands.hpp"
#include "bench/commands/progress_line.hpp"
#include "bench/run_folder.hpp"
#include "bench/runner.hpp"
#include "eval/table.hpp"

namespace evbench {
namespace {

constexpr int kExitFailed = 3;

struct RunArguments {
  std::string config;
  std::vector<std::string> overrides;
  std::string out = "results";
  bool quiet = false;
  bool check = false;
  bool problem = false;
};

int execute(const RunArguments& arguments) {
  const Experiment experiment = read_experiment(arguments.config, arguments.overrides);
  if (arguments.check) {
    fmt::print("{}: fine, {} run{}\n", arguments.config, experiment.runs.size(),
               experiment.runs.size() == 1 ? "" : "s");
    return 0;
  }
  const std::unique_ptr<Source> source = make_source(experiment.runs.front());
  std::vector<std::string> folders;
  bool failed = false;
  for (const RunConfig& config : experiment.runs) {
    RunFolder folder(arguments.out, config);
    ProgressLine line(fmt::format("[{}/{}] {}", folders.size() + 1, experiment.runs.size(), config.label),
                      arguments.quiet);
    const RunResult result = run(config, *source, [&](double t, double end) {
      line.update(fmt::format("{:.2f} of {:.2f} s", std::min(t, end), end));
    });
    folder.write(config, result, arguments.problem);
    folders.push_back(folder.path());
    failed = failed || result.status.state == RunState::failed;
  }
  if (!arguments.quiet) {
    fmt::print("{}", make_table(find_runs(folders), {}));
    fmt::print("\nwritten: {}\n", (std::filesystem::path(arguments.out) / experiment.name).string());
  }
  return failed ? kExitFailed : 0;
}

}  // namespace

void add_run(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "Run a config: one back-end, or a comparison on identical tracks");
  command->add_option("config", arguments->config, "JSON config")->required();
  command->add_option("--set", arguments->overrides, "Override a value: KEY=VALUE, e.g. backend.placement.rate=50")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(true);
  command->add_option("--out", arguments->out, "Folder for results")->capture_default_str();
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  command->add_flag("--problem", arguments->problem,
                    "Also write problem.txt: the problem that gp_map ended with, for evbench solve and other solvers");
  command->add_flag("--check", arguments->check, "Check the config and stop");
  command->footer(
      "Each run writes OUT/EXPERIMENT/RUN: config.json, manifest.json, final.tum, online.tum, map.ply, metrics.json,\n"
      "timing.csv, log.txt, status.json; a run of the same config before is replaced.\n"
      "Exit codes: 0 done (also when a run is degraded or lost: see its status), 2 bad input, 3 a run failed.");
  command->callback([arguments, &exit_code] { exit_code = execute(*arguments); });
}

}  // namespace evbench
