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
#include "bench/commands/run.hpp"
#include "bench/commands/run_outputs.hpp"
#include "bench/published.hpp"
#include "core/support/interruption.hpp"
#include "core/support/nearest.hpp"
#include "eval/find_runs.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

struct ReproduceArguments {
  std::vector<std::string> names;
  std::string configs, format = "text";
  RunArguments run;
};

constexpr const char* kConfigs = "configs/paper";

/// The folder with the configs: that of the repository if it is the working folder, else the installed one.
std::string find_folder(const std::string& asked) {
  std::error_code error;
  if (!asked.empty()) {
    if (fs::is_directory(asked, error)) return asked;
    throw InputError(fmt::format("{}: there is no such folder; expected one with configs, and published.json", asked));
  }
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const std::string installed = program.parent_path().parent_path() / "share/evbench" / kConfigs;
  for (const std::string& folder : {std::string(kConfigs), installed}) {
    if (fs::is_directory(folder, error)) return folder;
  }
  throw InputError(
      fmt::format("{}: there is no such folder here, and no {}. The paper's configs are in evbench's repository: "
                  "expected its folder as the working folder, or --configs REPOSITORY/{}",
                  kConfigs, installed, kConfigs));
}

/// All configs of the folder by name, or those asked for.
std::vector<std::string> find_configs(const ReproduceArguments& arguments) {
  std::vector<std::string> known;
  for (const auto& entry : fs::directory_iterator(arguments.configs)) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() == ".json" && name != "published") known.push_back(name);
  }
  std::ranges::sort(known, natural_less);
  for (const std::string& name : arguments.names) {
    if (std::ranges::find(known, name) != known.end()) continue;
    throw InputError(fmt::format("{} has no config \"{}\"{}", arguments.configs, name, suggestion(name, known)));
  }
  return arguments.names.empty() ? known : arguments.names;
}

int execute(ReproduceArguments& arguments, Plugins& plugins) {
  arguments.configs = find_folder(arguments.configs);
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
  command->footer(
      "Configs whose data are missing are left out and listed, with exit code 2; runs that are complete below OUT are\n"
      "not repeated.");
  command->callback([arguments, &plugins, &exit_code] { exit_code = execute(*arguments, plugins); });
}

}  // namespace evbench
