#pragma once

#include <string>

#include "core/events/reader.hpp"
#include "core/geometry/camera.hpp"

namespace evbench {

/// Throws InputError for a sensor larger than any that exists (64 million pixels): tables and images of the size that a
/// damaged header states would take all memory. 0 is unknown.
void check_sensor_size(const std::string& path, int width, int height);

/// Throws InputError, with both sizes, if a camera and a recording state different sensor sizes: they do not belong
/// together. A size that the recording's file itself does not state is not compared. `place` names the camera.
void check_same_sensor(const std::string& place, const Camera& camera, const StreamInfo& recording);

}  // namespace evbench
