#pragma once

#include <string>

namespace evbench {

/// A path that can be opened, sought in and opened again. A regular file or folder is that itself; what a pipe, a
/// device or "-" (the standard input) gives is copied into a TemporaryFile, once, which lasts as long as the program.
/// Waiting can be interrupted (interruption.hpp). Throws InputError when it can't be read, OutputError when it can't be
/// copied.
std::string seekable_path(const std::string& path);

}  // namespace evbench
