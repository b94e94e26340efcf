#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "bench/commands/command_line.hpp"
#include "bench/commands/commands.hpp"
#include "bench/commands/exit_code.hpp"
#include "bench/commands/failures.hpp"
#include "bench/plugins.hpp"
#include "bench/version.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace {

/// Prints an error message, which begins with the command. Returns the exit code.
int report(const std::string& command, const std::string& message, int exit_code) {
  fmt::print(stderr, "{}: {}\n", command, message);
  return exit_code;
}

int refuse(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  if (argc == 1) {
    fmt::print(stderr, "{}", app.help());
    return evbench::kExitBadInput;
  }
  const evbench::NamedCommand command = evbench::reached_command(app);
  const std::string text = evbench::explain(app, error, {argv + 1, argv + argc});
  return report(command.words, fmt::format("{}\n{}", text, evbench::usage_of(command)), evbench::kExitBadInput);
}

int run_program(int argc, char** argv) {
  CLI::App app{"evbench: a benchmark harness for back-ends of event-camera visual odometry"};
  app.name("evbench");
  app.set_version_flag("--version", evbench::version_text());
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Print this help and that of every command");
  app.fallthrough();  // --plugin may also come after a command
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
  evbench::add_commands(app, plugins, exit_code);
  const auto fail = [&](const std::string& message, int code) {
    return report(evbench::reached_command(app).words, message, code);
  };
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {  // for help, or the version
    app.exit(asked);
  } catch (const CLI::ParseError& error) {
    return refuse(app, error, argc, argv);
  } catch (const evbench::Interrupted& interrupted) {
    return fail(interrupted.what(), 128 + interrupted.signal());
  } catch (const evbench::OutputError& error) {
    return fail(error.what(), evbench::kExitNotWritten);
  } catch (const evbench::SeveralErrors& errors) {
    for (const std::string& message : errors.others()) fail(message, evbench::kExitBadInput);
    return fail(errors.what(), evbench::kExitBadInput);
  } catch (const std::filesystem::filesystem_error& error) {  // a folder that can't be read, links in a circle
    return fail(fmt::format("{}: {}", error.path1().string(), error.code().message()), evbench::kExitBadInput);
  } catch (const std::bad_alloc&) {
    return fail("the memory is not enough", evbench::kExitNotWritten);
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return evbench::kExitNotWritten;  // main() reports it
    return fail(error.what(), evbench::kExitBadInput);
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  const int exit_code = run_program(argc, argv);
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout) return exit_code;
  fmt::print(stderr, "evbench: the output can't be written to the standard output (disk full?)\n");
  return exit_code == evbench::kExitDone ? evbench::kExitNotWritten : exit_code;
}
