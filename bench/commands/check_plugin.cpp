#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/battery/battery.hpp"
#include "bench/commands/commands.hpp"
#include "bench/commands/exit_code.hpp"
#include "bench/commands/name_check.hpp"
#include "core/plugin/registry.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/support/json_reason.hpp"
#include "core/support/nearest.hpp"

namespace evbench {
namespace {

using namespace battery;

/// A kind of plugin: its registered names with their origins, and its battery.
struct Kind {
  std::string name;
  std::map<std::string, std::string> plugins;
  std::function<std::vector<Check>(const std::string& plugin)> checks;
};

template <class Interface>
Kind kind_of(const Plugins& plugins, std::function<std::vector<Check>(const std::string&)> checks) {
  Kind result{PluginKind<Interface>::name, {}, std::move(checks)};
  for (const auto& [name, entry] : plugins.of<Interface>().entries()) result.plugins[name] = entry.origin;
  return result;
}

/// The reason why a check fails; empty if it passes.
std::string failure(const Check& check) {
  try {
    check.run();
  } catch (const std::exception& error) {
    return error.what();
  } catch (...) {
    return "an exception that is no std::exception";
  }
  return "";
}

struct Arguments {
  std::vector<std::string> names;
  std::string kind, options = "{}", source;
};

Json parse(const std::string& text, const std::string& place) {
  try {
    return parse_json(text);
  } catch (const Json::parse_error& error) {
    throw InputError(fmt::format("{}: {} is not JSON: {}", place, text, json_reason(error)));
  }
}

/// The source for checks of front-ends.
std::unique_ptr<Source> make_source(const Plugins& plugins, const std::string& text) {
  const std::string place = "check-plugin: --source";
  Json json = parse(text, place);
  if (!json.is_object() || !json.contains("type") || !json["type"].is_string()) {
    throw InputError(place + ": expected an object with \"type\": the name of a source");
  }
  const auto& entry = plugins.of<Source>().find(json["type"].get<std::string>(), place);
  json.erase("type");
  return entry.make(entry.resolve(json, place, "."), {1, ".", place});
}

/// For front-ends that read events.
constexpr const char* kSimulatedEvents = R"({
  "type": "event_simulation", "duration": 0.6, "camera": {"width": 160, "height": 120, "focal_length": 140},
  "motion": {"kind": "smooth_random", "max_frequency": 1.0}, "scene": {"kind": "shapes"}
})";

/// Selects the named plugins; without names those from outside, or all if there are none.
void choose(std::vector<Kind>& kinds, const std::vector<std::string>& names) {
  std::vector<std::string> known;
  bool outside = false;
  for (const Kind& kind : kinds) {
    for (const auto& [name, origin] : kind.plugins) {
      known.push_back(name);
      outside = outside || origin != kBuiltIn;
    }
  }
  for (const std::string& name : names) {
    if (std::ranges::find(known, name) != known.end()) continue;
    throw InputError(fmt::format("no plugin is called \"{}\"{}", name, suggestion(name, known)));
  }
  for (Kind& kind : kinds) {
    std::erase_if(kind.plugins, [&](const auto& item) {
      if (names.empty()) return outside && item.second == kBuiltIn;
      return std::ranges::find(names, item.first) == names.end();
    });
  }
}

/// Number of checks that hold, and of all.
struct Count {
  int good = 0, all = 0;
};

/// Prints one line per check.
Count try_plugin(const std::vector<Check>& checks) {
  Count count;
  for (const Check& check : checks) {
    const std::string why = failure(check);
    fmt::print("  {} {}{}{}\n", why.empty() ? "ok   " : "FAILS", check.name, why.empty() ? "" : ": ", why);
    std::fflush(stdout);
    ++count.all;
    count.good += why.empty() ? 1 : 0;
  }
  return count;
}

/// Returns whether all checks hold. A plugin that can't be made with the options is an error if it was named, else it
/// is left out.
bool check_plugins(const Plugins& plugins, const Arguments& arguments) {
  const Json options = parse(arguments.options, "check-plugin: --options");
  const auto given = arguments.source.empty() ? nullptr : make_source(plugins, arguments.source);
  const auto events = make_source(plugins, kSimulatedEvents);
  const auto source_for = [&](const std::string& name) -> const Source& {
    if (given) return *given;
    return plugins.of<FrontEnd>().find(name, "check-plugin").reads_events ? *events : usual_source();
  };
  std::vector<Kind> kinds = {
      kind_of<Source>(plugins, [&](const std::string& name) { return source_checks(plugins, name, options); }),
      kind_of<FrontEnd>(
          plugins, [&](const std::string& name) { return frontend_checks(plugins, name, options, source_for(name)); }),
      kind_of<BackEnd>(plugins, [&](const std::string& name) { return backend_checks(plugins, name, options); })};
  std::erase_if(kinds, [&](const Kind& kind) { return !arguments.kind.empty() && kind.name != arguments.kind; });
  choose(kinds, arguments.names);
  Count total;
  for (const Kind& kind : kinds) {
    for (const auto& [name, origin] : kind.plugins) {
      const std::string title = fmt::format("{} {} ({}):", kind.name, name, origin);
      try {
        const std::vector<Check> checks = kind.checks(name);
        fmt::print("{}\n", title);
        const Count count = try_plugin(checks);
        total.good += count.good;
        total.all += count.all;
      } catch (const InputError& error) {
        if (!arguments.names.empty()) throw;
        fmt::print("{} left out: {}\n", title, error.what());
      }
    }
  }
  fmt::print("{} of {} checks hold\n", total.good, total.all);
  return total.good == total.all;
}

}  // namespace

void add_check_plugin(CLI::App& app, const Plugins& plugins, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("check-plugin", "Check that plugins meet the requirements of their kind");
  command->add_option("name", arguments->names, "Names; by default all plugins from outside, or all if there are none");
  command->add_option("--kind", arguments->kind, "source, frontend or backend; by default each kind")
      ->check(one_of({"source", "frontend", "backend"}));
  command->add_option("--options", arguments->options, "The plugin's options, a JSON object")->capture_default_str();
  command->add_option(
      "--source", arguments->source,
      "Source for checks of front-ends, as in a config: {\"type\": NAME, options}; by default simulated "
      "tracks, and simulated events with tracks for those that read events");
  command->footer("Prints one line per check. Exit codes: 0 all hold, 2 bad input, 3 one fails.");
  command->callback([arguments, &plugins, &exit_code] {
    if (!check_plugins(plugins, *arguments)) exit_code = kExitFailed;
  });
}

}  // namespace evbench
