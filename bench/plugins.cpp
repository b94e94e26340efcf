#include "bench/plugins.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <sstream>

#include "bench/experiment.hpp"
#include "core/plugin/library.hpp"
#include "core/support/error.hpp"

namespace evbench {

namespace {

/// What is wrong with a library is told with the place that names it.
void load(Plugins& plugins, const std::string& path, const std::string& place) {
  try {
    load_plugin_libraries(plugins, path);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", place, error.what()));
  }
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

void load_plugins_of(Plugins& plugins, const std::string& config, const std::vector<std::string>& overrides) {
  for (const std::string& path : read_plugin_paths(config, overrides)) load(plugins, path, config + ": plugins");
}

}  // namespace evbench
