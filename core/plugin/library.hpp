#pragma once

#include <string>

#include "core/plugin/registry.hpp"

namespace evbench {

/// Adds the plugins of a shared library, or of all shared libraries (*.so) in a folder, in the order of their names.
/// Such a library is what evbench_add_plugin (cmake/EvbenchPlugin.cmake) makes. It stays loaded until the program ends;
/// its path, without links, is the plugins' origin, and one that `plugins` has plugins of already is not loaded again.
///
/// Throws InputError, a sentence with the library's path, when there is no such file, it can't be loaded (not a shared
/// library, a symbol or a library that it needs is missing), it is no plugin, it was built for an evbench of another
/// ABI (abi.hpp; told before any of its code runs), its registration throws, it registers nothing, or a name is taken.
/// Nothing of the library at fault has been added then; those of a folder that come before it have.
void load_plugin_libraries(Plugins& plugins, const std::string& path);

/// The shared libraries that a path names, without links, and that `plugins` has nothing of. Throws InputError for
/// a path that names none.
std::vector<std::string> unloaded_libraries(const Plugins& plugins, const std::string& path);

}  // namespace evbench
