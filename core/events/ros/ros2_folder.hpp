#pragma once

#include "core/events/formats.hpp"

namespace evbench {

/// The folder of a ROS 2 recording: metadata.yaml and the files that it names, MCAP or SQLite, read one after the
/// other.
EventFormat ros2_folder_format();

}  // namespace evbench
