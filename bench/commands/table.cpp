#include "eval/table.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "bench/commands/commands.hpp"
#include "bench/commands/failures.hpp"
#include "bench/common_time.hpp"
#include "core/io/atomic_file.hpp"
#include "eval/find_runs.hpp"

namespace evbench {
namespace {

struct TableArguments {
  std::vector<std::string> folders;
  std::string format = "text";
  std::string out;
  bool force = false;
  TableOptions options;
};

void execute(const TableArguments& arguments) {
  const std::filesystem::path folder = std::filesystem::path(arguments.out).parent_path();  // of a run, perhaps
  check_outputs({arguments.out}, {folder / "metrics.json", folder / "config.json"}, arguments.force);
  TableOptions options = arguments.options;
  options.format = parse_name<TableFormat>(kTableFormatNames, arguments.format, "table format");
  std::vector<std::string> unreadable;
  std::vector<RunRecord> runs = find_runs(arguments.folders, &unreadable);
  if (runs.empty()) throw_together(unreadable);
  if (shows_common_time(options, runs.size())) score_common_time(runs, options.online);
  const std::string table = make_table(runs, options);
  if (arguments.out.empty()) {
    fmt::print("{}", table);
  } else {
    write_file(arguments.out, table);
  }
  throw_together(unreadable);
}

}  // namespace

void add_table(CLI::App& app) {
  auto arguments = std::make_shared<TableArguments>();
  CLI::App* command =
      app.add_subcommand("table", "Make a table of runs: text, Markdown, CSV, LaTeX; with statistics over seeds");
  command->add_option("folders", arguments->folders, "Folders of runs, searched with all folders below")
      ->required()
      ->type_name("DIR");
  command
      ->add_option(
          "--format", arguments->format,
          "Format; latex has few columns, see --metrics, and needs booktabs; long: CSV, a line a run and metric")
      ->check(CLI::IsMember(to_strings(kTableFormatNames)))
      ->capture_default_str();
  command->add_option("--out", arguments->out, "Write to this file instead of the terminal")->type_name("FILE");
  command->add_flag("--force", arguments->force, "Replace the file of --out where it exists");
  command
      ->add_option("--metrics", arguments->options.metrics,
                   "Columns, e.g. ate.trans_m.rmse,rpe.trans_m.median,runtime_s")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("KEY,...");
  command
      ->add_option("--over", arguments->options.over,
                   "Summarise: a row for all runs that differ in nothing else, e.g. seed, or seed,experiment")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAME,...");
  command->add_flag("--online", arguments->options.online, "Scores of the poses as estimated when they were made");
  command->callback([arguments] { execute(*arguments); });
}

}  // namespace evbench
