#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "bench/commands/commands.hpp"
#include "bench/commands/exit_code.hpp"
#include "bench/plugins.hpp"
#include "bench/version.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"
#include "core/support/nearest.hpp"

namespace {

/// A sentence where a word stands in the place of a command and is none; empty: that is not what is wrong.
std::string command_suggestion(const CLI::App& app, int argc, char** argv) {
  const CLI::App* place = &app;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto commands = place->get_subcommands({});
    if (commands.empty() || word.empty() || word.starts_with('-')) return "";
    const auto found = std::ranges::find(commands, word, [](const CLI::App* command) { return command->get_name(); });
    if (found == commands.end()) {
      std::vector<std::string> names;
      for (const CLI::App* command : commands) names.push_back(command->get_name());
      return fmt::format("evbench: \"{}\" is no command{}\n", word, evbench::suggestion(word, names));
    }
    place = *found;
  }
  return "";
}

int run_program(int argc, char** argv) {
  CLI::App app{"evbench: a benchmark harness for back-ends of event-camera visual odometry"};
  app.name("evbench");
  app.set_version_flag("--version", evbench::version_text());
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Print this help and that of every command");
  app.fallthrough();  // so that --plugin may stand after a command, too
  evbench::Plugins plugins;
  evbench::add_registered_plugins(plugins, evbench::kBuiltIn);
  std::vector<std::string> libraries;
  app.add_option(
         "--plugin", libraries,
         "A library with plugins, or a folder of them; can be given often, and in EVBENCH_PLUGINS, between colons")
      ->type_name("PATH")
      ->allow_extra_args(false);
  bool no_external = false;
  app.add_flag("--no-external", no_external,
               "Refuse commands that a config starts and libraries that a config alone names")
      ->envname("EVBENCH_NO_EXTERNAL");
  app.parse_complete_callback([&] {  // before any command's
    if (no_external) plugins.refuse_external_code();
    evbench::load_plugins(plugins, libraries);
  });
  int exit_code = evbench::kExitDone;
  evbench::add_run(app, plugins, exit_code);
  evbench::add_sweep(app, plugins, exit_code);
  evbench::add_status(app, exit_code);
  evbench::add_task(app, plugins, exit_code);
  evbench::add_reproduce(app, plugins, exit_code);
  evbench::add_eval(app);
  evbench::add_score(app);
  evbench::add_table(app);
  evbench::add_compare(app);
  evbench::add_figure(app);
  evbench::add_export(app, plugins);
  evbench::add_list(app, plugins);
  evbench::add_describe(app, plugins);
  evbench::add_solve(app);
  evbench::add_info(app, plugins);
  evbench::add_convert(app, plugins);
  evbench::add_dataset(app);
  evbench::add_render(app, plugins);
  evbench::add_new_config(app, plugins);
  evbench::add_new_plugin(app, plugins);
  evbench::add_check_plugin(app, plugins, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (const std::string text = command_suggestion(app, argc, argv); !text.empty()) {
      fmt::print(stderr, "{}", text);
      return evbench::kExitBadInput;
    }
    if (argc == 1) {
      fmt::print(stderr, "{}", app.help());
      return evbench::kExitBadInput;
    }
    return app.exit(error) == 0 ? evbench::kExitDone : evbench::kExitBadInput;
  } catch (const evbench::Interrupted& interrupted) {
    fmt::print(stderr, "evbench: {}\n", interrupted.what());
    return 128 + interrupted.signal();
  } catch (const evbench::OutputError& error) {
    fmt::print(stderr, "evbench: {}\n", error.what());
    return evbench::kExitNotWritten;
  } catch (const std::filesystem::filesystem_error& error) {  // a folder that can't be read, links in a circle
    fmt::print(stderr, "evbench: {}: {}\n", error.path1().string(), error.code().message());
    return evbench::kExitBadInput;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "evbench: the memory is not enough\n");
    return evbench::kExitNotWritten;
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return evbench::kExitNotWritten;  // is told at the end
    fmt::print(stderr, "evbench: {}\n", error.what());
    return evbench::kExitBadInput;
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  const int exit_code = run_program(argc, argv);
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout) return exit_code;
  fmt::print(stderr, "evbench: what was to be printed can't be written to the standard output (disk full?)\n");
  return exit_code == evbench::kExitDone ? evbench::kExitNotWritten : exit_code;
}
