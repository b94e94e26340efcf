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
#include "bench/published.hpp"
#include "core/support/interruption.hpp"
#include "core/support/nearest.hpp"
#include "eval/find_runs.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

struct ReproduceArguments {
  std::vector<std::string> names;
  std::string configs = "configs/paper", format = "text";
  RunArguments run;
};

/// All configs of the folder by name, or those asked for.
std::vector<std::string> find_configs(const ReproduceArguments& arguments) {
  std::error_code error;
  if (!fs::is_directory(arguments.configs, error)) {
    throw InputError(
        fmt::format("{}: there is no such folder here. The paper's configs are in evbench's repository: expected its "
                    "folder as the working folder, or --configs REPOSITORY/configs/paper",
                    arguments.configs));
  }
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

int execute(const ReproduceArguments& arguments, Plugins& plugins) {
  const std::vector<std::string> names = find_configs(arguments);
  const Published published = read_published(arguments.configs + "/published.json");
  std::vector<std::string> folders, failures;
  int exit_code = kExitDone;
  for (const std::string& name : names) {
    RunArguments run = arguments.run;
    run.config = fmt::format("{}/{}.json", arguments.configs, name);
    if (!run.quiet) fmt::print("== {}\n", name);
    try {
      exit_code = std::max(exit_code, run_config(run, plugins));
      folders.push_back(run.out + "/" + name);
    } catch (const Interrupted&) {
      throw;
    } catch (const OutputError&) {
      throw;
    } catch (const InputError& error) {  // data that is not here, mostly: the others are done all the same
      failures.push_back(fmt::format("{} is left out: {}", name, error.what()));
    }
  }
  if (folders.empty()) throw_together(failures);
  const auto format = parse_name<TableFormat>(kTableFormatNames, arguments.format, "table format");
  fmt::print("{}{}", arguments.run.quiet ? "" : "\n", published_table(published, find_runs(folders), format));
  throw_together(failures);
  return exit_code;
}

}  // namespace

void add_reproduce(CLI::App& app, Plugins& plugins, int& exit_code) {
  auto arguments = std::make_shared<ReproduceArguments>();
  CLI::App* command =
      app.add_subcommand("reproduce", "Run the paper's experiments, and put our numbers and the paper's side by side");
  command->add_option("names", arguments->names, "Configs by name, e.g. table1_simulated; none: all")
      ->type_name("NAME");
  command->add_option("--configs", arguments->configs, "Folder with the configs, and published.json with the numbers")
      ->capture_default_str()
      ->type_name("DIR");
  command->add_option("--out", arguments->run.out, "Folder for results")->capture_default_str();
  add_overrides(*command, arguments->run.overrides, "Override a value of all configs: KEY=VALUE, e.g. seed=3");
  command->add_option("--format", arguments->format, "Format of the table")
      ->check(one_of({"text", "markdown", "csv", "latex"}))
      ->capture_default_str();
  command->add_flag("--force", arguments->run.force, "Do runs again that are complete already");
  command->add_flag("--quiet", arguments->run.quiet, "Print nothing but the table and errors");
  command->footer(
      "Configs whose data is not here are left out and named, with an exit code of 2; what is complete below OUT is "
      "not\n"
      "run again.");
  command->callback([arguments, &plugins, &exit_code] { exit_code = execute(*arguments, plugins); });
}

}  // namespace evbench
