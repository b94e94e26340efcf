#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>

#include "bench/commands/commands.hpp"
#include "bench/commands/exit_code.hpp"
#include "bench/commands/number_check.hpp"
#include "bench/sweep/manifest.hpp"
#include "bench/sweep/process_pool.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

struct TaskArguments {
  std::string manifest;
  std::size_t line = 1, stride = 0;
};

int execute(const TaskArguments& arguments, Plugins& plugins) {
  const Interruption interruption(arguments.manifest + ": interrupted; complete runs are kept");
  stay_without_threads();
  int exit_code = kExitDone;
  const Announce announce = announcement(false);
  const std::vector<ManifestLine> lines =
      read_manifest(arguments.manifest, arguments.line, arguments.stride, plugins, {.announce = announce});
  std::vector<const Job*> jobs;
  for (const ManifestLine& line : lines) jobs.push_back(&line.run.config.job);
  announce_commands(jobs, plugins, announce);
  for (const ManifestLine& line : lines) {
    const SweepProgress now = do_runs({line.run}, plugins, line.options, [](const SweepProgress&) {});
    for (const TroubledRun& run : now.troubled) fmt::print("{}\n", describe(run));
    if (now.troubled.empty()) fmt::print("done: {}, {}\n", line.run.config.label, place_of(line.run.axes));
    std::fflush(stdout);
    if (now.failed > 0) exit_code = kExitFailed;
  }
  return exit_code;
}

}  // namespace

void add_task(CLI::App& app, Plugins& plugins, int& exit_code) {
  auto arguments = std::make_shared<TaskArguments>();
  CLI::App* command = app.add_subcommand("task", "Run a line of the manifest of evbench sweep");
  command->add_option("manifest", arguments->manifest, "manifest.jsonl")->required();
  command->add_option("line", arguments->line, "Number of the line, from 1")->required()->check(above_zero());
  command->add_option("--stride", arguments->stride, "Also run every N-th line after it; 0: only that line");
  command->footer("Exit codes: as of evbench run.");
  command->callback([arguments, &plugins, &exit_code] { exit_code = execute(*arguments, plugins); });
}

}  // namespace evbench
