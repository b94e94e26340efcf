#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <utility>

#include "bench/commands/commands.hpp"
#include "bench/commands/name_check.hpp"
#include "bench/experiment.hpp"
#include "core/events/formats.hpp"
#include "core/plugin/registry.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "eval/protocols.hpp"

namespace evbench {
namespace {

template <class Interface>
void list(const Plugins& plugins) {
  fmt::print("{}:\n", PluginKind<Interface>::name);
  for (const auto& [name, entry] : plugins.of<Interface>().entries()) {
    const std::string origin = entry.origin == kBuiltIn ? "" : fmt::format(" ({})", entry.origin);
    fmt::print("  {:<20} {:>2}  {}{}\n", name, entry.version, entry.text, origin);
  }
}

/// False if there is no such plugin of this kind. An empty kind matches any.
template <class Interface>
bool describe(const Plugins& plugins, const std::string& kind, const std::string& name, bool schema) {
  const std::string own = PluginKind<Interface>::name;
  if (kind.empty() ? !plugins.of<Interface>().entries().contains(name) : kind != own) return false;
  const auto& entry = plugins.of<Interface>().find(name, own);
  if (schema) {
    fmt::print("{}\n", dump_json(entry.schema(), 2));
  } else {
    fmt::print("{} {}: {}\n\n{}", own, name, entry.text, entry.describe());
  }
  return true;
}

}  // namespace

void add_list(CLI::App& app, const Plugins& plugins) {
  auto what = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand(
      "list", "List sources, front-ends, back-ends with the versions of their results, formats of events, protocols");
  command->add_option("what", *what, "protocols: how each of them scores, and who publishes by it")
      ->check(one_of({"protocols"}));
  command->callback([what, &plugins] {
    if (*what == "protocols") {
      fmt::print("{}", describe_protocols());
      return;
    }
    list<Source>(plugins);
    list<FrontEnd>(plugins);
    list<BackEnd>(plugins);
    fmt::print("formats of events:\n");
    for (const EventFormat& format : event_formats()) fmt::print("  {:<20} {}\n", format.name, format.description);
    fmt::print("  {:<20} {}\n", "config", "JSON config of evbench: the events of its source");
    fmt::print("protocols of scores:\n");
    for (const NamedProtocol& protocol : named_protocols()) fmt::print("  {:<20} {}\n", protocol.name, protocol.source);
  });
}

void add_describe(CLI::App& app, const Plugins& plugins) {
  struct Arguments {
    std::string kind, name;
    bool schema = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("describe", "Describe a plugin's options, or a config file");
  command->add_option("kind", arguments->kind, "source, frontend, backend or config; or just a plugin's name")
      ->required();
  command->add_option("name", arguments->name, "Name of the plugin (evbench list)");
  command->add_flag("--schema", arguments->schema, "Print a JSON Schema, for editors");
  command->callback([arguments, &plugins] {
    const bool schema = arguments->schema;
    std::string kind = arguments->kind, name = arguments->name;
    if (kind == "config") {
      if (!name.empty()) throw InputError(fmt::format("config: expected no name with it, but got {}", name));
      fmt::print("{}\n", schema ? dump_json(experiment_schema(plugins), 2) : describe_experiment());
      return;
    }
    if (name.empty()) std::swap(kind, name);
    if (!describe<Source>(plugins, kind, name, schema) && !describe<FrontEnd>(plugins, kind, name, schema) &&
        !describe<BackEnd>(plugins, kind, name, schema)) {
      throw InputError(fmt::format(
          "{}: expected config, a plugin's name, or source, frontend or backend and a name; see evbench list",
          arguments->kind));
    }
  });
}

}  // namespace evbench
