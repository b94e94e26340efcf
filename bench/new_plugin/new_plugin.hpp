#pragma once

#include <string>

namespace evbench {

/// Writes a small repository with a plugin to start from: one source file, one test, CMakeLists.txt, config.json,
/// README.md. `kind`: backend, frontend, source, or backend_minimal, which has no test and no README.md. `folder` is
/// made, with its parent folders, unless it exists and is empty. Throws InputError if the name is not [a-z][a-z0-9_]*
/// or is reserved by CMake, if the folder is not empty, and if it can't be written; no file is left behind then.
void write_new_plugin(const std::string& kind, const std::string& name, const std::string& folder);

}  // namespace evbench
