#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "bench/commands/commands.hpp"
#include "bench/commands/protocol_option.hpp"
#include "bench/commands/run_outputs.hpp"
#include "bench/commands/run_selection.hpp"
#include "bench/run_folder.hpp"
#include "bench/run_index.hpp"
#include "bench/scores_by_protocol.hpp"
#include "core/support/interruption.hpp"
#include "eval/protocols.hpp"
#include "eval/table.hpp"

namespace evbench {
namespace {

struct ScoreArguments {
  std::vector<std::string> folders;
  std::string config, protocol;
  std::vector<std::string> overrides;
  bool quiet = false;
};

ScoreOptions protocol_of(const std::string& folder, const ScoreArguments& arguments) {
  if (!arguments.protocol.empty()) return options_by_protocol(arguments.protocol, protocol_of_run(folder));
  return arguments.config.empty() ? protocol_of_run(folder, arguments.overrides)
                                  : read_evaluation(arguments.config, Json(), arguments.overrides, "");
}

void execute(const ScoreArguments& arguments) {
  const Interruption interruption("interrupted; the runs that were not scored again are as before");
  use_runs(arguments.folders, [&](std::vector<RunRecord>& records) {
    std::erase_if(records, [](const RunRecord& run) { return !run.done; });  // runs of a sweep that are still to do
    if (records.empty()) throw InputError("none of these runs was done yet; expected some to score");
    std::vector<ScoreOptions> protocols;  // all of them first: errors are reported before any work
    for (const RunRecord& run : records) {
      protocols.push_back(protocol_of(run.folder, arguments));
      require_scores(run.folder, protocols.back());
    }
    for (std::size_t i = 0; i < records.size(); ++i) {
      check_interruption();
      const std::string found_as = records[i].folder;
      records[i] = score_again(std::filesystem::canonical(found_as).string(), protocols[i]);
      records[i].folder = found_as;
    }
    std::set<std::string> experiments;
    for (const RunRecord& run : records)
      experiments.insert(std::filesystem::canonical(run.folder).parent_path().string());
    for (const std::string& experiment : experiments) {
      if (std::filesystem::exists(experiment + "/index.csv")) write_run_index(experiment);
    }
    if (arguments.quiet) return;
    score_common_time(records, false);
    fmt::print("{}", make_table(records, {.layout = {.width = text_width()}}));
  });
}

}  // namespace

void add_score(CLI::App& app) {
  auto arguments = std::make_shared<ScoreArguments>();
  CLI::App* command = app.add_subcommand("score", "Score runs again from their trajectories, without running them");
  add_folders(*command, arguments->folders);
  command->add_option("--config", arguments->config, "Take the protocol from this config, not from each run's own")
      ->type_name("FILE");
  add_protocol_name(*command, arguments->protocol, "Score by a published protocol: evbench list protocols")
      ->excludes("--config");
  add_overrides(*command, arguments->overrides,
                "Override a value of the protocol: evaluation.KEY=VALUE, e.g. evaluation.alignment=se3");
  command->get_option("--protocol")->excludes("--set");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  command->footer(
      "Reads final.tum, causal.tum, causal_poses.txt and groundtruth.tum of each run, rewrites its metrics.json, and\n"
      "its config.json with the protocol. The same protocol gives identical files.");
  command->callback([arguments] { execute(*arguments); });
}

}  // namespace evbench
