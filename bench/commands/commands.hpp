#pragma once

#include <CLI/CLI.hpp>

namespace evbench {

/// Each adds a subcommand of `evbench`; its callback throws InputError, which `main` catches.
void add_eval(CLI::App& app);
void add_table(CLI::App& app);
void add_list(CLI::App& app);
void add_describe(CLI::App& app);
void add_solve(CLI::App& app);
void add_info(CLI::App& app);
void add_convert(CLI::App& app);
void add_dataset(CLI::App& app);
void add_render(CLI::App& app);

/// `exit_code` is set to what the program returns: 0, or 3 when a run failed.
void add_run(CLI::App& app, int& exit_code);

/// The options of commands that read events.
struct ReadOptions;
void add_read_options(CLI::App& command, ReadOptions& options);

}  // namespace evbench
