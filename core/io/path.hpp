#pragma once

#include <string>

namespace evbench {

/// A path as written in a config: ${NAME} is replaced by the environment variable, then a relative path is taken from
/// `folder`. Throws InputError for a variable that is not set and for an unclosed ${.
std::string resolve_path(const std::string& path, const std::string& folder);

/// A relative path taken from `folder`; environment variables stay as they are written.
std::string anchored_path(const std::string& path, const std::string& folder);

/// Where a symbolic link leads in the end, whether or not something is there; any other path as it is. Throws
/// InputError for links that lead in a circle.
std::string follow_links(const std::string& path);

}  // namespace evbench
