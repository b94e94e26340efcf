#include "bench/plugins.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <sstream>

#include "bench/experiment.hpp"
#include "bench/runner.hpp"
#include "core/plugin/library.hpp"
#include "core/support/error.hpp"

namespace evbench {

namespace {

/// Calls `use`. Errors about a library begin with the place that names it.
void at_place(const std::string& place, const std::function<void()>& use) {
  try {
    use();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", place, error.what()));
  }
}

std::vector<std::string> libraries_to_load(const Plugins& plugins, const std::vector<std::string>& paths,
                                           const std::string& place) {
  std::vector<std::string> libraries;
  for (const std::string& path : paths) {
    at_place(place, [&] { std::ranges::move(unloaded_libraries(plugins, path), std::back_inserter(libraries)); });
  }
  return libraries;
}

void load(Plugins& plugins, const std::string& path, const std::string& place) {
  at_place(place, [&] { load_plugin_libraries(plugins, path); });
}

}  // namespace

void load_plugins(Plugins& plugins, const std::vector<std::string>& paths) {
  const char* const variable = std::getenv("EVBENCH_PLUGINS");  // NOLINT(concurrency-mt-unsafe): before any thread
  std::istringstream named(variable == nullptr ? "" : variable);
  for (std::string path; std::getline(named, path, ':');) {
    if (!path.empty()) load(plugins, path, "EVBENCH_PLUGINS");
  }
  for (const std::string& path : paths) load(plugins, path, "--plugin");
}

void load_named_plugins(Plugins& plugins, const std::vector<std::string>& paths, const std::string& place,
                        const LibraryPolicy& policy) {
  const std::vector<std::string> libraries = libraries_to_load(plugins, paths, place);
  if (libraries.empty()) return;
  const std::string refused_by = plugins.external_code_allowed() ? policy.refused_by : "--no-external";
  if (!refused_by.empty()) {
    throw InputError(fmt::format("{}: names {}, which {} does not load; --plugin {} does", place,
                                 fmt::join(libraries, ", "), refused_by, fmt::join(libraries, " --plugin ")));
  }
  if (policy.announce) policy.announce(fmt::format("loads, as {} says: {}", place, fmt::join(libraries, ", ")));
  for (const std::string& library : libraries) load(plugins, library, place);
}

void load_plugins_of(Plugins& plugins, const std::string& config, const std::vector<std::string>& overrides,
                     const LibraryPolicy& policy) {
  load_named_plugins(plugins, read_plugin_paths(config, overrides), config + ": plugins", policy);
}

std::string missing_libraries(const Plugins& plugins, const std::string& config,
                              const std::vector<std::string>& overrides) {
  const std::vector<std::string> libraries =
      libraries_to_load(plugins, read_plugin_paths(config, overrides), config + ": plugins");
  if (libraries.empty()) return "";
  return fmt::format("{} is not loaded, as only the config names it; --plugin {} loads it", fmt::join(libraries, ", "),
                     fmt::join(libraries, " --plugin "));
}

void announce_commands(const std::vector<const Job*>& jobs, const Plugins& plugins, const Announce& announce) {
  std::vector<std::string> commands;
  for (const Job* job : jobs) {
    for (const std::string& command : commands_of(*job, plugins)) {
      if (std::ranges::find(commands, command) == commands.end()) commands.push_back(command);
    }
  }
  if (!commands.empty() && announce) announce(fmt::format("runs, as the config says: {}", fmt::join(commands, "; ")));
}

}  // namespace evbench
