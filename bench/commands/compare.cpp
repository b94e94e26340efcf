#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "bench/commands/commands.hpp"
#include "bench/commands/failures.hpp"
#include "bench/common_time.hpp"
#include "core/io/atomic_file.hpp"
#include "eval/comparison_table.hpp"
#include "eval/find_runs.hpp"

namespace evbench {
namespace {

struct CompareArguments {
  std::vector<std::string> folders;
  std::string format = "text", out;
  bool force = false;
  ComparisonOptions options;
};

void execute(const CompareArguments& arguments) {
  check_outputs({arguments.out}, {}, arguments.force);
  ComparisonOptions options = arguments.options;
  options.format = parse_name<TableFormat>(kTableFormatNames, arguments.format, "table format");
  std::vector<std::string> unreadable;
  std::vector<RunRecord> runs = find_runs(arguments.folders, &unreadable);
  if (runs.empty()) throw_together(unreadable);
  if (any_of_common_time(options.metrics)) score_common_time(runs, options.online);
  const std::string table = make_comparison_table(runs, options);
  if (arguments.out.empty()) {
    fmt::print("{}", table);
  } else {
    write_file(arguments.out, table);
  }
  throw_together(unreadable);
}

}  // namespace

void add_compare(CLI::App& app) {
  auto arguments = std::make_shared<CompareArguments>();
  CLI::App* command = app.add_subcommand("compare", "Compare back-ends pair by pair on the same data, with statistics");
  command->add_option("folders", arguments->folders, "Folders of runs, searched with all folders below")
      ->required()
      ->type_name("DIR");
  command->add_option("--base", arguments->options.base, "What the others are compared with: its label; else the first")
      ->type_name("NAME");
  command
      ->add_option("--metrics", arguments->options.metrics,
                   "What is compared, e.g. ate.trans_m.rmse,common.rpe.trans_m.rmse,times.backend_ms.p99")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("KEY,...");
  command->add_flag("--online", arguments->options.online, "Scores of the poses as estimated when they were made");
  command->add_option("--format", arguments->format, "Format")
      ->check(CLI::IsMember({"text", "markdown", "csv", "latex"}))
      ->capture_default_str();
  command->add_option("--out", arguments->out, "Write to this file instead of the terminal")->type_name("FILE");
  command->add_flag("--force", arguments->force, "Replace the file of --out where it exists");
  command->callback([arguments] { execute(*arguments); });
}

}  // namespace evbench
