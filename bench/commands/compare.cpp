#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "bench/commands/causal_flag.hpp"
#include "bench/commands/commands.hpp"
#include "bench/commands/name_check.hpp"
#include "bench/commands/run_outputs.hpp"
#include "bench/commands/run_selection.hpp"
#include "bench/scores_by_protocol.hpp"
#include "eval/comparison_table.hpp"

namespace evbench {
namespace {

struct CompareArguments {
  RunSelection runs;
  std::string format = "text";
  TextOutput out;
  ComparisonOptions options;
  bool wide = false;
};

void execute(const CompareArguments& arguments) {
  arguments.out.check();
  ComparisonOptions options = arguments.options;
  options.format = parse_name<TableFormat>(kTableFormatNames, arguments.format, "table format");
  use_runs(arguments.runs, [&](std::vector<RunRecord>& runs) {
    if (any_of_common_time(options.metrics)) score_common_time(runs, options.causal);
    arguments.out.write(make_comparison_table(runs, options));
  });
}

}  // namespace

void add_compare(CLI::App& app) {
  auto arguments = std::make_shared<CompareArguments>();
  CLI::App* command =
      app.add_subcommand("compare", "Compare back-ends or front-ends pair by pair on the same data, with statistics");
  add_run_selection(*command, arguments->runs);
  command
      ->add_option("--base", arguments->options.base,
                   "Label of the back-end with which the others are compared; by default the first")
      ->type_name("NAME");
  command->add_flag("--front-ends", arguments->options.front_ends,
                    "Compare front-ends, too: pairs are runs of the same source and seed");
  add_list_option(*command, "--metrics", arguments->options.metrics,
                  "Metrics to compare, e.g. ate.trans_m.rmse,common.rpe.trans_m.rmse,times.backend_ms.p99");
  add_causal_flag(*command, arguments->options.causal, "Scores of the causal poses, as first published");
  command->add_option("--format", arguments->format, "Format")
      ->check(one_of({"text", "markdown", "csv", "latex"}))
      ->capture_default_str();
  add_text_output(*command, arguments->out);
  add_wide(*command, arguments->options.layout, arguments->wide);
  command->add_flag("--body", arguments->options.layout.body, "LaTeX: only the tabular, without float and caption");
  command->callback([arguments] { execute(*arguments); });
}

}  // namespace evbench
