#pragma once

#include <string>

#include "core/events/ros/messages.hpp"
#include "core/geometry/camera.hpp"

namespace evbench::ros {

/// ROS says so by a camera matrix of zeros.
bool is_calibrated(const CameraInfo& info);

/// The camera that a message describes, checked as a calibration file is. Size [px]: what the message leaves unsaid
/// (0). Throws InputError, with the topic, for a lens model that evbench does not have and for numbers that no camera
/// has.
Camera camera_of(const CameraInfo& info, const std::string& topic, int width, int height);

}  // namespace evbench::ros
