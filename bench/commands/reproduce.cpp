#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/commands/commands.hpp"
#include "bench/commands/exit_code.hpp"
#include "bench/commands/failures.hpp"
#include "bench/commands/name_check.hpp"
#include "bench/commands/reference_experiments.hpp"
#include "bench/commands/run.hpp"
#include "bench/commands/run_outputs.hpp"
#include "bench/published.hpp"
#include "bench/reference.hpp"
#include "core/support/interruption.hpp"
#include "core/support/nearest.hpp"
#include "eval/find_runs.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

struct ReproduceArguments {
  std::vector<std::string> names;
  std::string configs, format = "text";
  bool reference = false;
  int jobs = 0;
  RunArguments run;
};

/// The names asked for, or all. Throws InputError for one that is not known in `place`.
std::vector<std::string> chosen(const std::vector<std::string>& asked, const std::vector<std::string>& known,
                                const std::string& place, const char* kind) {
  for (const std::string& name : asked) {
    if (std::ranges::find(known, name) != known.end()) continue;
    throw InputError(fmt::format("{} has no {} \"{}\"{}", place, kind, name, suggestion(name, known)));
  }
  return asked.empty() ? known : asked;
}

/// All configs of the folder by name, or those asked for.
std::vector<std::string> find_configs(const ReproduceArguments& arguments) {
  std::vector<std::string> known;
  for (const auto& entry : fs::directory_iterator(arguments.configs)) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() == ".json" && name != "published") known.push_back(name);
  }
  std::ranges::sort(known, natural_less);
  return chosen(arguments.names, known, arguments.configs, "config");
}

/// The runs of each sequence of the benchmark beside other systems' numbers.
void print_sequences(const PublishedBenchmark& benchmark, const std::vector<RunRecord>& runs, TableFormat format) {
  for (const std::string& sequence : benchmark.sequences) {
    std::vector<RunRecord> of_one;
    std::ranges::copy_if(runs, std::back_inserter(of_one),
                         [&](const RunRecord& run) { return sequence_in(benchmark, run) == sequence; });
    if (of_one.empty()) continue;
    fmt::print("\n{}",
               published_sequence_table(benchmark, sequence, std::move(of_one), format, {.width = text_width()}));
  }
}

/// How far these runs of an experiment are from the results in this repository, if it has any.
void print_difference(const std::string& name, const std::vector<RunRecord>& runs) {
  const std::string csv = fmt::format("results/reference/{}.csv", name);
  std::error_code error;
  if (runs.empty() || !fs::is_regular_file(csv, error)) return;
  fmt::print("\n{}: {}\n", name, compare_with_reference(runs, csv));
}

/// The experiments of the reference results, each with how far it is from the committed numbers.
int reproduce_reference(const ReproduceArguments& arguments) {
  const std::vector<ReferenceExperiment> experiments = read_reference_experiments(kReferenceExperiments);
  std::vector<std::string> known;
  for (const ReferenceExperiment& experiment : experiments) known.push_back(experiment.name);
  std::vector<std::string> failures;
  int exit_code = kExitDone;
  for (const std::string& name : chosen(arguments.names, known, kReferenceExperiments, "experiment")) {
    const ReferenceExperiment& experiment = *std::ranges::find(experiments, name, &ReferenceExperiment::name);
    fmt::print("== {}\n", name);
    try {
      exit_code = std::max(exit_code, run_reference_experiment(experiment, arguments.jobs));
      std::vector<RunRecord> runs = find_runs(std::vector{"results/" + name});
      std::erase_if(runs, [](const RunRecord& run) { return !run.done; });
      print_difference(name, runs);
    } catch (const Interrupted&) {
      throw;
    } catch (const OutputError&) {
      throw;
    } catch (const InputError& error) {  // the other experiments are run all the same
      failures.push_back(fmt::format("{}: {}", name, error.what()));
    }
  }
  throw_together(failures);
  return exit_code;
}

int execute(ReproduceArguments& arguments, Plugins& plugins) {
  if (arguments.reference) return reproduce_reference(arguments);
  arguments.configs = find_paper_configs(arguments.configs);
  const std::vector<std::string> names = find_configs(arguments);
  const Published published = read_published(arguments.configs + "/published.json");
  std::vector<RunRecord> runs;
  std::vector<std::string> failures;
  int exit_code = kExitDone;
  for (const std::string& name : names) {
    RunArguments run = arguments.run;
    run.config = fmt::format("{}/{}.json", arguments.configs, name);
    if (!run.quiet) fmt::print("== {}\n", name);
    try {
      exit_code = std::max(exit_code, run_config(run, plugins, &runs));
    } catch (const Interrupted&) {
      throw;
    } catch (const OutputError&) {
      throw;
    } catch (const InputError& error) {  // mostly missing data: the other configs are run all the same
      failures.push_back(fmt::format("{} is left out: {}", name, error.what()));
    }
  }
  if (runs.empty()) throw_together(failures);
  const auto format = parse_name<TableFormat>(kTableFormatNames, arguments.format, "table format");
  fmt::print("{}{}", arguments.run.quiet ? "" : "\n",
             published_table(published, runs, format, {.width = text_width()}));
  if (published.benchmark) print_sequences(*published.benchmark, runs, format);
  if (!arguments.run.quiet && arguments.run.overrides.empty()) {
    for (const std::string& name : names) {
      std::vector<RunRecord> of_one;
      std::ranges::copy_if(runs, std::back_inserter(of_one),
                           [&](const RunRecord& run) { return run.experiment == name; });
      print_difference(name, of_one);
    }
  }
  throw_together(failures);
  return exit_code;
}

}  // namespace

void add_reproduce(CLI::App& app, Plugins& plugins, int& exit_code) {
  auto arguments = std::make_shared<ReproduceArguments>();
  CLI::App* command =
      app.add_subcommand("reproduce", "Run the paper's experiments, and compare the results with the published ones");
  command->add_option("names", arguments->names, "Configs by name, e.g. table1_simulated; none: all")
      ->type_name("NAME");
  CLI::Option* reference = command->add_flag(
      "--reference", arguments->reference,
      fmt::format("Instead the experiments of this repository's reference results ({}), in results/NAME, and how far "
                  "the new numbers are from the committed ones",
                  kReferenceExperiments));
  command->add_option("-j,--jobs", arguments->jobs, "--reference: runs at a time; by default one per processor")
      ->check(CLI::Range(1, 4096))
      ->needs(reference);
  command
      ->add_option("--configs", arguments->configs,
                   "Folder with the configs, and published.json with the numbers; by default configs/paper here, or "
                   "where evbench is installed")
      ->type_name("DIR");
  command->add_option("--out", arguments->run.out, "Folder for results")->capture_default_str();
  add_overrides(*command, arguments->run.overrides, "Override a value of all configs: KEY=VALUE, e.g. seed=3");
  command->add_option("--format", arguments->format, "Format of the table")
      ->check(one_of({"text", "markdown", "csv", "latex"}))
      ->capture_default_str();
  command->add_flag("--force", arguments->run.force, "Repeat runs that are complete already");
  command->add_flag("--quiet", arguments->run.quiet, "Print nothing but the table and errors");
  for (const char* option : {"--configs", "--out", "--set", "--format", "--force", "--quiet"}) {
    command->get_option(option)->excludes(reference);
  }
  command->footer(
      "Configs whose data are missing are left out and listed, with exit code 2; runs that are complete below OUT are\n"
      "not repeated.");
  command->callback([arguments, &plugins, &exit_code] { exit_code = execute(*arguments, plugins); });
}

}  // namespace evbench
