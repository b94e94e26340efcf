#include "eval/table.hpp"

#include <fmt/format.h>

#include <memory>

#include "bench/commands/commands.hpp"
#include "core/io/atomic_file.hpp"

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
  refuse_to_replace(arguments.out, arguments.force);
  TableOptions options = arguments.options;
  options.format = parse_name<TableFormat>(kTableFormatNames, arguments.format, "table format");
  const std::string table = make_table(find_runs(arguments.folders), options);
  if (arguments.out.empty()) {
    fmt::print("{}", table);
  } else {
    write_file(arguments.out, table);
  }
}

}  // namespace

void add_table(CLI::App& app) {
  auto arguments = std::make_shared<TableArguments>();
  CLI::App* command = app.add_subcommand("table", "Make a table of runs: text, Markdown, CSV, LaTeX");
  command->add_option("folders", arguments->folders, "Folders of runs, searched with all folders below")
      ->required()
      ->type_name("DIR");
  command->add_option("--format", arguments->format, "Format; latex has few columns, see --metrics, and needs booktabs")
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
  command->add_flag("--online", arguments->options.online, "Scores of the poses as estimated when they were made");
  command->callback([arguments] { execute(*arguments); });
}

}  // namespace evbench
