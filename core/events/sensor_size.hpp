#pragma once

#include <string>

#include "core/events/reader.hpp"
#include "core/geometry/camera.hpp"

namespace evbench {

/// Throws InputError for a sensor beyond any that is made (64 million pixels): the tables and pictures of what a
/// damaged header says would take all memory. 0 is unknown.
void check_sensor_size(const std::string& path, int width, int height);

/// Throws InputError, with both sizes, where a camera and a recording say different sizes of the sensor: then one is
/// not the other's. What the recording's file does not say itself is not compared. `place` names the camera.
void check_same_sensor(const std::string& place, const Camera& camera, const StreamInfo& recording);

}  // namespace evbench
