#pragma once

#include <string>

#include "core/plugin/options.hpp"

namespace evbench {

/// The content of a file; throws InputError, naming it, when it can't be opened or is no JSON.
Json read_json_file(const std::string& path);

}  // namespace evbench
