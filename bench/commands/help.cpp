#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "bench/commands/command_line.hpp"
#include "bench/commands/commands.hpp"
#include "bench/commands/completion.hpp"
#include "bench/commands/man_page.hpp"
#include "bench/commands/name_check.hpp"

namespace evbench {

void add_help(CLI::App& app) {
  auto shell = std::make_shared<std::string>();
  CLI::App* completion =
      app.add_subcommand("completion", "Print the completion script for a shell; it is also installed");
  completion->add_option("shell", *shell, "The shell")->required()->check(one_of({"bash", "zsh"}));
  completion->footer("If evbench is not installed: source <(evbench completion bash)");
  completion->callback(
      [shell, &app] { fmt::print("{}", *shell == "zsh" ? zsh_completion(app) : bash_completion(app)); });

  CLI::App* man = app.add_subcommand("man", "Print the manual page; it is also installed");
  man->footer("If evbench is not installed: evbench man | man -l -");
  man->callback([&app] { fmt::print("{}", man_page(app)); });

  auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* help = app.add_subcommand("help", "Print the help of a command, e.g. help run");
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  help->add_option("command", *words, "The command; none: all of them")
      ->type_name(fmt::format("{{{}}}", fmt::join(names, ",")));
  help->callback([words, &app] { fmt::print("{}", help_of(find_command(app, *words))); });
}

}  // namespace evbench
