#pragma once

#include <string>

namespace evbench {

extern const char* const kVersion;
extern const char* const kCommit;  ///< that was built; "unknown" outside a checkout
extern const char* const kBuild;   ///< build type and compiler

std::string version_text();

}  // namespace evbench
