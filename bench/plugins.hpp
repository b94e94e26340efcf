#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/job.hpp"
#include "core/plugin/registry.hpp"

namespace evbench {

/// Adds the plugins from outside that a command line asks for: of the libraries and folders that the environment
/// variable EVBENCH_PLUGINS names, between colons, then of `paths` (--plugin). Throws InputError as
/// load_plugin_libraries() does; the message begins with the place that names the path.
void load_plugins(Plugins& plugins, const std::vector<std::string>& paths);

/// A sentence is told before code is run that a file alone names: its author is not who runs it.
using Announce = std::function<void(const std::string&)>;

/// What becomes of libraries that a file alone names and that are not loaded yet.
struct LibraryPolicy {
  std::string refused_by = {};  ///< what loads none, e.g. "--dry-run"; empty: they are loaded
  Announce announce = {};
};

/// Loads libraries and folders of them that `place` names. Throws InputError where that is refused, by the policy or
/// as external code is (--no-external), and as load_plugin_libraries() does.
void load_named_plugins(Plugins& plugins, const std::vector<std::string>& paths, const std::string& place,
                        const LibraryPolicy& policy);

/// Likewise those of a config's key "plugins"; overrides as in read_experiment().
void load_plugins_of(Plugins& plugins, const std::string& config, const std::vector<std::string>& overrides,
                     const LibraryPolicy& policy);

/// For who only looks at a config: which libraries it names that are therefore not loaded, and how they would be;
/// empty: none.
std::string missing_libraries(const Plugins& plugins, const std::string& config,
                              const std::vector<std::string>& overrides);

/// Announces the commands that jobs' plugins start. Throws InputError where there are any and external code is refused.
void announce_commands(const std::vector<const Job*>& jobs, const Plugins& plugins, const Announce& announce);

}  // namespace evbench
