#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/commands/causal_flag.hpp"
#include "bench/commands/commands.hpp"
#include "bench/commands/name_check.hpp"
#include "bench/commands/number_check.hpp"
#include "bench/commands/run_outputs.hpp"
#include "bench/commands/run_selection.hpp"
#include "bench/figures/run_figures.hpp"
#include "bench/scores_by_protocol.hpp"
#include "core/io/atomic_file.hpp"
#include "eval/table.hpp"

namespace evbench {
namespace {

/// A kind of figure, its function, and the options that only some kinds have.
struct FigureKind {
  const char* name;
  const char* text;
  Figure (*make)(std::span<const RunRecord> runs, const FigureOptions& options);
  std::vector<std::string> options;
};

const std::vector<FigureKind>& figure_kinds() {
  static const std::vector<FigureKind> kinds = {
      {"sweep",
       "metrics against an axis: medians, and bands between the quartiles of all other runs",
       sweep_figure,
       {"--metrics", "--axis", "--axis-label", "--causal"}},
      {"map",
       "against an axis and across another one: the ratio of a metric to that of another method",
       map_figure,
       {"--metrics", "--axis", "--axis-label", "--across", "--base", "--causal"}},
      {"box", "quartiles and median of each back-end's runs, and the runs", box_figure, {"--metrics", "--causal"}},
      {"error", "errors over time of a sequence's runs", error_figure, {"--causal"}},
      {"position", "x, y and z over time, with the ground truth", position_figure, {"--causal"}},
      {"trajectory", "from three sides, with the ground truth", trajectory_figure, {"--causal"}},
      {"times", "the distribution of the times of updates", times_figure, {}},
      {"profile",
       "performance profiles: the share of sequences and seeds within a factor of the best",
       profile_figure,
       {"--metrics", "--causal"}},
  };
  return kinds;
}

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (const FigureKind& kind : figure_kinds()) names.emplace_back(kind.name);
  return names;
}

const FigureKind& find_kind(const std::string& name) {
  return *std::ranges::find(figure_kinds(), name, &FigureKind::name);  // CLI11 has checked it
}

/// Throws InputError for an option that only other kinds have.
void check_options(const CLI::App& command, const FigureKind& kind) {
  for (const FigureKind& other : figure_kinds()) {
    for (const std::string& option : other.options) {
      if (command.count(option) == 0 || std::ranges::find(kind.options, option) != kind.options.end()) continue;
      throw InputError(fmt::format(
          "{} has no effect on a figure of the kind {}; of the options that only some kinds have it takes {}", option,
          kind.name, kind.options.empty() ? "none" : fmt::format("{}", fmt::join(kind.options, ", "))));
    }
  }
}

struct FigureArguments {
  std::string kind;
  RunSelection runs;
  std::string out, python;
  double width_mm = 0.0, height_mm = 0.0;  ///< 0: the figure's own
  bool keep_script = false, force = false, no_caption = false;
  FigureOptions options;
};

void execute(const FigureArguments& arguments) {
  const std::filesystem::path out(arguments.out);
  const std::string script = std::filesystem::path(out).replace_extension(".py").string();
  check_figure_name(arguments.out);
  check_outputs({arguments.out, arguments.keep_script ? script : ""}, {}, arguments.force);
  use_runs(arguments.runs, [&](std::vector<RunRecord>& runs) {
    if (any_of_common_time(arguments.options.metrics)) score_common_time(runs, arguments.options.causal);
    Figure figure = find_kind(arguments.kind).make(runs, arguments.options);
    if (arguments.width_mm > 0.0) figure.width_mm = arguments.width_mm;
    if (arguments.height_mm > 0.0) figure.height_mm = arguments.height_mm;
    if (arguments.no_caption) figure.caption.clear();
    for (const std::string& remark : figure.remarks) fmt::print(stderr, "remark: {}\n", remark);
    if (arguments.keep_script) write_file(script, drawing_script(figure));
    const std::string warnings = draw(figure, arguments.out, arguments.python);
    if (!warnings.empty()) fmt::print(stderr, "{}: is drawn, but Python warns:{}\n", arguments.out, warnings);
  });
}

}  // namespace

void add_figure(CLI::App& app) {
  auto arguments = std::make_shared<FigureArguments>();
  CLI::App* command =
      app.add_subcommand("figure", "Draw runs for a paper: sweeps, boxes, errors, trajectories, profiles");
  command->add_option("kind", arguments->kind, "Kind of figure")->required()->check(one_of(kind_names()));
  add_run_selection(*command, arguments->runs);
  command->add_option("--out", arguments->out, "The file: .svg, .pdf or .png")->required()->type_name("FILE");
  add_list_option(*command, "--metrics", arguments->options.metrics, "Metrics, one panel each; by default ATE and RPE");
  command->add_option("--axis", arguments->options.axis, "Axis of a sweep, e.g. backend.batch_duration")
      ->type_name("NAME");
  command->add_option("--axis-label", arguments->options.axis_label, "Label of that axis, e.g. \"batch duration [s]\"")
      ->type_name("TEXT");
  command->add_option("--across", arguments->options.across, "The other axis of a map")->type_name("NAME");
  command->add_option("--base", arguments->options.base, "Reference of a map; by default the method without the axis")
      ->type_name("METHOD");
  add_causal_flag(*command, arguments->options.causal, "The causal poses, as first published");
  command->add_option("--width", arguments->width_mm, "Width [mm]; by default 174, that of a page")
      ->check(in_range(20.0, 2000.0));
  command->add_option("--height", arguments->height_mm, "Height of the panels, without legend and caption [mm]")
      ->check(in_range(20.0, 2000.0));
  command->add_flag("--no-caption", arguments->no_caption, "Draw no caption below the figure");
  command->add_flag("--keep-script", arguments->keep_script,
                    "Also write FILE with the extension .py: the Python script that draws it, to edit by hand");
  command->add_option("--python", arguments->python, "A Python with matplotlib; by default python3")
      ->type_name("PROGRAM");
  command->add_flag("--force", arguments->force, "Replace files that exist");
  std::string kinds;
  for (const FigureKind& kind : figure_kinds()) {
    kinds += fmt::format("{}{:<12}{}{}", kinds.empty() ? "" : "\n", kind.name, kind.text,
                         kind.options.empty() ? "" : fmt::format("\n{:<12}{}", "", fmt::join(kind.options, " ")));
  }
  command->footer(kinds);
  command->callback([arguments, command] {
    check_options(*command, find_kind(arguments->kind));
    execute(*arguments);
  });
}

}  // namespace evbench
