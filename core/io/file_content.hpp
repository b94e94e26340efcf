#pragma once

#include <optional>
#include <string>

namespace evbench {

/// Whether there is a regular file at this path, or a link to one.
bool is_file(const std::string& path);

/// A file's bytes; none if it can't be read.
std::optional<std::string> file_content(const std::string& path);

}  // namespace evbench
