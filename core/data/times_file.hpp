#pragma once

#include <string>
#include <vector>

namespace evbench {

/// Reads a file with a time [s] in the first column of each line. Throws InputError with file and line for anything
/// else, and for a file without times.
std::vector<double> read_times(const std::string& path);

}  // namespace evbench
