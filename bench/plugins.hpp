#pragma once

#include <string>
#include <vector>

#include "core/plugin/registry.hpp"

namespace evbench {

/// Adds the plugins from outside that a command line asks for: of the libraries and folders that the environment
/// variable EVBENCH_PLUGINS names, between colons, then of `paths` (--plugin). Throws InputError as
/// load_plugin_libraries() does; for a path of the variable the message says that it stands there.
void load_plugins(Plugins& plugins, const std::vector<std::string>& paths);

}  // namespace evbench
