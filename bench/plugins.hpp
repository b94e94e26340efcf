#pragma once

#include <string>
#include <vector>

#include "core/plugin/registry.hpp"

namespace evbench {

/// Adds the plugins from outside that a command line asks for: of the libraries and folders that the environment
/// variable EVBENCH_PLUGINS names, between colons, then of `paths` (--plugin). Throws InputError as
/// load_plugin_libraries() does; the message begins with the place that names the path.
void load_plugins(Plugins& plugins, const std::vector<std::string>& paths);

/// Likewise of the libraries and folders that a config's key "plugins" names; overrides as in read_experiment().
void load_plugins_of(Plugins& plugins, const std::string& config, const std::vector<std::string>& overrides);

}  // namespace evbench
