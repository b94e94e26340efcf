#pragma once

#include <string>

namespace evbench {

/// Resolves a path of a config: replaces ${NAME} by the environment variable, then makes a relative path relative to
/// `folder`. Throws InputError for a variable that is not set and for an unclosed ${.
std::string resolve_path(const std::string& path, const std::string& folder);

/// Makes a relative path relative to `folder`; environment variables are not replaced.
std::string anchored_path(const std::string& path, const std::string& folder);

/// The final target of a symbolic link, whether or not it exists; other paths are returned unchanged. Throws InputError
/// for links that form a circle.
std::string follow_links(const std::string& path);

}  // namespace evbench
