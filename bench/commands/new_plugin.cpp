#include "bench/new_plugin/new_plugin.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "bench/commands/commands.hpp"
#include "bench/commands/name_check.hpp"
#include "core/plugin/registry.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

template <class Interface>
void expect_free(const Plugins& plugins, const std::string& kind, const std::string& name) {
  if (kind != PluginKind<Interface>::name) return;
  const auto& entries = plugins.of<Interface>().entries();
  const auto known = entries.find(name);
  if (known == entries.end()) return;
  throw InputError(fmt::format("new-plugin: there is a {} \"{}\" already ({}); expected another name", kind, name,
                               known->second.origin));
}

}  // namespace

void add_new_plugin(CLI::App& app, const Plugins& plugins) {
  struct Arguments {
    std::string kind, name, out;
    bool minimal = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("new-plugin", "Write a small repository with a working plugin to start from");
  command->add_option("kind", arguments->kind, "source, frontend or backend")
      ->required()
      ->check(one_of({"source", "frontend", "backend"}));
  command->add_option("name", arguments->name, "Name of the plugin: lower-case letters, digits and _")->required();
  command->add_option("--out", arguments->out, "Folder to make; by default NAME");
  command->add_flag("--minimal", arguments->minimal, "A back-end in the fewest lines that run, without a test");
  command->footer(
      "In that folder, three commands take it to a row in a table:\n"
      "  cmake -B build\n  cmake --build build\n  evbench --plugin build/libNAME.so run config.json");
  command->callback([arguments, &plugins] {
    const auto& [kind, name, out, minimal] = *arguments;
    if (minimal && kind != PluginKind<BackEnd>::name) {
      throw InputError(fmt::format("--minimal: is for a backend; this is a {}", kind));
    }
    expect_free<Source>(plugins, kind, name);
    expect_free<FrontEnd>(plugins, kind, name);
    expect_free<BackEnd>(plugins, kind, name);
    const std::string folder = out.empty() ? name : out;
    write_new_plugin(minimal ? kind + "_minimal" : kind, name, folder);
    fmt::print(
        "written: {0}\n  cd {0}\n  cmake -B build\n  cmake --build build\n  evbench --plugin build/lib{1}.so run "
        "config.json\n",
        folder, name);
  });
}

}  // namespace evbench
