#pragma once

#include <string>

namespace evbench {

/// A path that can be opened several times and supports seeking. For a regular file or folder it is the path itself.
/// The data of a pipe, a device or "-" (the standard input) are copied once into a TemporaryFile, which exists until
/// the program ends. Waiting can be interrupted (interruption.hpp). Throws InputError if the data can't be read,
/// OutputError if they can't be copied.
std::string seekable_path(const std::string& path);

}  // namespace evbench
