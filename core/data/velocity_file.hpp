#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/motion/body_velocities.hpp"

namespace evbench {

/// The content of velocities.txt, a line per time: t wx wy wz vx vy vz. Numbers are read back unchanged.
std::string format_velocities(std::span<const StampedVelocity> velocities);

/// Reads such a file. Throws InputError with file and line for a damaged file and for times that do not rise.
BodyVelocities read_velocities(const std::string& path);

}  // namespace evbench
