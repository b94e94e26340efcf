#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/data/landmark.hpp"

namespace evbench {

/// A map as a PLY file, ASCII: x y z and the track of each landmark.
std::string format_map(std::span<const Landmark> map);

/// Reads such a file. Throws InputError with file and line for anything that format_map() does not write.
std::vector<Landmark> read_map(const std::string& path);

}  // namespace evbench
