#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "core/plugin/registry.hpp"

namespace evbench {

/// Adds all commands, in the order of the help.
void add_commands(CLI::App& app, Plugins& plugins, int& exit_code);

/// Each adds a subcommand of `evbench`; its callback throws InputError, which `main` catches. `plugins` must outlive
/// the program's parsing.
void add_eval(CLI::App& app);
void add_eval_tracks(CLI::App& app);
void add_table(CLI::App& app);
void add_compare(CLI::App& app);
void add_figure(CLI::App& app);
void add_score(CLI::App& app);
void add_list(CLI::App& app, const Plugins& plugins);
void add_describe(CLI::App& app, const Plugins& plugins);
void add_solve(CLI::App& app);
void add_info(CLI::App& app, const Plugins& plugins);
void add_convert(CLI::App& app, const Plugins& plugins);
void add_dataset(CLI::App& app);
void add_render(CLI::App& app, const Plugins& plugins);
void add_report(CLI::App& app);
void add_new_config(CLI::App& app, const Plugins& plugins);
void add_new_plugin(CLI::App& app, const Plugins& plugins);

void add_export(CLI::App& app, const Plugins& plugins);

/// `exit_code` is set to what the program returns: 0, or 3 when a run failed. Plugins of libraries that a config names
/// are added.
void add_run(CLI::App& app, Plugins& plugins, int& exit_code);
void add_reproduce(CLI::App& app, Plugins& plugins, int& exit_code);
void add_sweep(CLI::App& app, Plugins& plugins, int& exit_code);
void add_task(CLI::App& app, Plugins& plugins, int& exit_code);

/// `exit_code`: 3 when runs failed or are still to be done.
void add_status(CLI::App& app, int& exit_code);

/// `exit_code`: 3 when a check fails.
void add_check_plugin(CLI::App& app, const Plugins& plugins, int& exit_code);

/// The commands about the others: help, completion, man. To be added last.
void add_help(CLI::App& app);

/// The repeatable option --set KEY=VALUE of commands that read configs; `text`: its help.
void add_overrides(CLI::App& command, std::vector<std::string>& overrides, const std::string& text);

/// Prints to the standard output which commands or libraries of a config are about to be used; prints nothing if
/// `quiet`.
std::function<void(const std::string&)> announcement(bool quiet);

/// The options of commands that read events.
struct ReadOptions;
void add_read_options(CLI::App& command, ReadOptions& options);

}  // namespace evbench
