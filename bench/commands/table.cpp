#include "eval/table.hpp"

#include <memory>

#include "bench/commands/causal_flag.hpp"
#include "bench/commands/commands.hpp"
#include "bench/commands/name_check.hpp"
#include "bench/commands/number_check.hpp"
#include "bench/commands/protocol_option.hpp"
#include "bench/commands/run_outputs.hpp"
#include "bench/commands/run_selection.hpp"
#include "bench/published.hpp"
#include "bench/scores_by_protocol.hpp"

namespace evbench {
namespace {

struct TableArguments {
  RunSelection runs;
  std::string format = "text", protocol, published;
  TextOutput out;
  bool list_metrics = false;
  TableOptions options;
};

void execute(const TableArguments& arguments) {
  arguments.out.check();
  if (arguments.list_metrics) {
    use_runs(arguments.runs, [&](const std::vector<RunRecord>& runs) { arguments.out.write(list_metrics(runs)); });
    return;
  }
  TableOptions options = arguments.options;
  options.format = parse_name<TableFormat>(kTableFormatNames, arguments.format, "table format");
  use_runs(arguments.runs, [&](std::vector<RunRecord>& runs) {
    if (!arguments.published.empty()) {
      const Published published = read_published(find_paper_configs("") + "/published.json");
      if (!published.benchmark) throw InputError("published.json has no \"benchmark\"");
      arguments.out.write(
          published_sequence_table(*published.benchmark, arguments.published, runs, options.format, options.layout));
      return;
    }
    if (!arguments.protocol.empty()) score_by_protocol(runs, arguments.protocol);
    if (shows_common_time(options, runs.size())) score_common_time(runs, options.causal, arguments.protocol);
    arguments.out.write(make_table(runs, options));
  });
}

}  // namespace

void add_table(CLI::App& app) {
  auto arguments = std::make_shared<TableArguments>();
  CLI::App* command =
      app.add_subcommand("table", "Make a table of runs: text, Markdown, CSV, LaTeX; with statistics over seeds");
  add_run_selection(*command, arguments->runs);
  command
      ->add_option("--format", arguments->format,
                   "Format; latex has few columns and needs the packages booktabs and siunitx; long: CSV with a line "
                   "per run and metric")
      ->check(one_of(to_strings(kTableFormatNames)))
      ->capture_default_str();
  add_text_output(*command, arguments->out);
  add_list_option(*command, "--metrics,--columns", arguments->options.metrics,
                  "Columns, e.g. ate.trans_m.rmse,rpe.trans_m.median,runtime_s; also key, folder and status");
  add_wide(*command, arguments->options.layout, arguments->options.folders);
  command->add_flag("--body", arguments->options.layout.body, "LaTeX: only the tabular, without float and caption");
  add_protocol_name(*command, arguments->protocol,
                    "Score by a published protocol (evbench list protocols) for this table; the runs stay as they are");
  command
      ->add_option(
          "--published", arguments->published,
          "Put these runs beside the numbers that other systems published of this sequence of the Event-Camera "
          "Dataset, each by its own protocol")
      ->type_name("SEQUENCE");
  add_list_option(*command, "--over", arguments->options.over,
                  "Summarise over these columns: one row for all runs that differ only in these, e.g. seed, or "
                  "seed,experiment",
                  "NAME,...");
  add_list_option(*command, "--by", arguments->options.by,
                  "Summarise over all columns in which runs differ but these: one row for each label and each of their "
                  "values, e.g. texture; with --success",
                  "NAME,...");
  command
      ->add_option(
          "--success", arguments->options.success,
          "With --over: share of runs with an ATE of at most so many percent of the path, and how many are off "
          "by twice as much with status ok; with --by: 1")
      ->type_name("PERCENT")
      ->check(above_zero());
  command->add_flag("--list-metrics", arguments->list_metrics,
                    "List the keys for --metrics: all numbers of these runs, and their names in tables");
  add_causal_flag(*command, arguments->options.causal, "Scores of the causal poses, as first published");
  for (const char* other : {"--protocol", "--metrics", "--over", "--by", "--success", "--causal", "--list-metrics"}) {
    command->get_option("--published")->excludes(other);
  }
  command->callback([arguments] { execute(*arguments); });
}

}  // namespace evbench
