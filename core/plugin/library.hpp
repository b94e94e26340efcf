#pragma once

#include <string>

#include "core/plugin/registry.hpp"

namespace evbench {

/// Adds the plugins of a shared library, or of all shared libraries (*.so) in a folder, in the order of their names.
/// evbench_add_plugin (cmake/EvbenchPlugin.cmake) builds such libraries. A library stays loaded until the program ends.
/// Its path, with links resolved, is the origin of its plugins; a library whose plugins are in `plugins` already is not
/// loaded again.
///
/// Throws InputError, a sentence with the library's path, when the file does not exist, can't be loaded (not a shared
/// library, a missing symbol or dependency), is no plugin, was built for an evbench of another ABI (abi.hpp; checked
/// before any of its code runs), throws during registration, registers nothing, or a name is taken. Nothing of the
/// failing library is added then; earlier libraries of the same folder are.
void load_plugin_libraries(Plugins& plugins, const std::string& path);

/// The shared libraries that a path names (links resolved) and that are not in `plugins` yet. Throws InputError for a
/// path that names none.
std::vector<std::string> unloaded_libraries(const Plugins& plugins, const std::string& path);

}  // namespace evbench
