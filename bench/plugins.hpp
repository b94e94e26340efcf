#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/job.hpp"
#include "core/plugin/registry.hpp"

namespace evbench {

/// Loads plugins from outside for a command line: from the libraries and folders in the environment variable
/// EVBENCH_PLUGINS, separated by colons, then from `paths` (--plugin). Throws InputError as load_plugin_libraries()
/// does; the message begins with the origin of the path.
void load_plugins(Plugins& plugins, const std::vector<std::string>& paths);

/// Prints a message before code is run that only a file names, because its author may not be the user.
using Announce = std::function<void(const std::string&)>;

/// Whether libraries that only a file names, and that are not loaded yet, are loaded.
struct LibraryPolicy {
  std::string refused_by = {};  ///< the option that forbids it, e.g. "--dry-run"; empty: they are loaded
  Announce announce = {};
};

/// Loads libraries and folders of them that `place` names. Throws InputError if the policy or --no-external forbids it,
/// and as load_plugin_libraries() does.
void load_named_plugins(Plugins& plugins, const std::vector<std::string>& paths, const std::string& place,
                        const LibraryPolicy& policy);

/// Loads the libraries in a config's key "plugins"; overrides as in read_experiment().
void load_plugins_of(Plugins& plugins, const std::string& config, const std::vector<std::string>& overrides,
                     const LibraryPolicy& policy);

/// For commands that only check a config: a message about its libraries that are not loaded, and how to load them.
/// Empty if there are none.
std::string missing_libraries(const Plugins& plugins, const std::string& config,
                              const std::vector<std::string>& overrides);

/// Announces the commands that jobs' plugins start. Throws InputError if there are any and --no-external is given.
void announce_commands(const std::vector<const Job*>& jobs, const Plugins& plugins, const Announce& announce);

}  // namespace evbench
