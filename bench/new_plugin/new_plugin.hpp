#pragma once

#include <string>

namespace evbench {

/// Writes a small repository with a plugin to start from: one source, one test, CMakeLists.txt, config.json, README.md.
/// `kind`: backend, frontend, source, or backend_minimal, which has no test and no README.md; `folder` is made, with the folders above it; an empty one will do.
/// Throws InputError when the name is none ([a-z][a-z0-9_]*, none of the names that CMake keeps for itself), when
/// something is in the folder already, and when it can't be written; nothing is left of it then.
void write_new_plugin(const std::string& kind, const std::string& name, const std::string& folder);

}  // namespace evbench
