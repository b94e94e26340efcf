#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "bench/commands/commands.hpp"
#include "bench/experiment.hpp"
#include "core/events/formats.hpp"
#include "core/plugin/registry.hpp"

namespace evbench {
namespace {

template <class Interface>
void list(const Plugins& plugins) {
  fmt::print("{}:\n", PluginKind<Interface>::name);
  for (const auto& [name, entry] : plugins.of<Interface>().entries()) {
    const std::string origin = entry.origin == kBuiltIn ? "" : fmt::format(" ({})", entry.origin);
    fmt::print("  {:<20} {}{}\n", name, entry.text, origin);
  }
}

template <class Interface>
bool describe(const Plugins& plugins, const std::string& kind, const std::string& name, bool schema) {
  if (kind != PluginKind<Interface>::name) return false;
  const auto& entry = plugins.of<Interface>().find(name, "describe " + kind);
  if (schema) {
    fmt::print("{}\n", entry.schema().dump(2));
  } else {
    fmt::print("{} {}: {}\n\n{}", kind, name, entry.text, entry.describe());
  }
  return true;
}

}  // namespace

void add_list(CLI::App& app, const Plugins& plugins) {
  CLI::App* command = app.add_subcommand("list", "List sources, front-ends, back-ends and formats of events");
  command->callback([&plugins] {
    list<Source>(plugins);
    list<FrontEnd>(plugins);
    list<BackEnd>(plugins);
    fmt::print("formats of events:\n");
    for (const EventFormat& format : event_formats()) fmt::print("  {:<20} {}\n", format.name, format.description);
    fmt::print("  {:<20} {}\n", "config", "JSON config of evbench: the events of its source");
  });
}

void add_describe(CLI::App& app, const Plugins& plugins) {
  struct Arguments {
    std::string kind, name;
    bool schema = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("describe", "Describe a plugin's options, or a config file");
  command->add_option("kind", arguments->kind, "source, frontend, backend or config")
      ->required()
      ->check(CLI::IsMember({"source", "frontend", "backend", "config"}));
  command->add_option("name", arguments->name, "Name of the plugin (evbench list)");
  command->add_flag("--schema", arguments->schema, "Print a JSON Schema, for editors");
  command->callback([arguments, &plugins] {
    const auto& [kind, name, schema] = *arguments;
    if (kind == "config") {
      fmt::print("{}\n", schema ? experiment_schema(plugins).dump(2) : describe_experiment());
      return;
    }
    if (name.empty())
      throw InputError(fmt::format("describe {}: expected the name of a {}; see evbench list", kind, kind));
    describe<Source>(plugins, kind, name, schema) || describe<FrontEnd>(plugins, kind, name, schema) ||
        describe<BackEnd>(plugins, kind, name, schema);
  });
}

}  // namespace evbench
