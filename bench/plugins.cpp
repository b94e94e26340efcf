#include "bench/plugins.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <sstream>

#include "core/plugin/library.hpp"
#include "core/support/error.hpp"

namespace evbench {

void load_plugins(Plugins& plugins, const std::vector<std::string>& paths) {
  const char* const variable = std::getenv("EVBENCH_PLUGINS");  // NOLINT(concurrency-mt-unsafe): before any thread
  std::istringstream named(variable == nullptr ? "" : variable);
  for (std::string path; std::getline(named, path, ':');) {
    if (path.empty()) continue;
    try {
      load_plugin_libraries(plugins, path);
    } catch (const InputError& error) {
      throw InputError(fmt::format("EVBENCH_PLUGINS: {}", error.what()));
    }
  }
  for (const std::string& path : paths) load_plugin_libraries(plugins, path);
}

}  // namespace evbench
