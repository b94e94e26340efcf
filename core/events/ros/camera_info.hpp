#pragma once

#include <string>

#include "core/events/ros/messages.hpp"
#include "core/geometry/camera.hpp"

namespace evbench::ros {

/// Is the camera calibrated? ROS says that it is not by a camera matrix of zeros.
bool is_calibrated(const CameraInfo& info);

/// The camera that a message describes, checked like a calibration file. `width`, `height` [px]: used if the message
/// does not state them (0). Throws InputError, with the topic, for a lens model that evbench does not have and for
/// impossible numbers.
Camera camera_of(const CameraInfo& info, const std::string& topic, int width, int height);

}  // namespace evbench::ros
