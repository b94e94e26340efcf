#pragma once

#include <string>

#include "core/geometry/camera.hpp"

namespace evbench {

/// Reads a camera's calibration: text of one record, as the Event-Camera Dataset's calib.txt, `fx fy cx cy` and the
/// coefficients that checked_camera() takes (k1 k2 p1 p2 k3), or YAML as yaml_camera() takes it. Size [px]
/// and lens model are those of the file; what it does not say is the caller's. `camera`: which one of several.
/// Throws InputError for another number of columns or records, a value that is not finite, a focal length ≤ 0, a
/// principal point outside the image, a lens model that there is not.
Camera read_calib(const std::string& path, int width, int height,
                  DistortionModel model = DistortionModel::radial_tangential, const std::string& camera = "");

/// The record that read_calib() reads back as the same camera; one without a lens as radial_tangential, all of it 0.
std::string format_calib(const Camera& camera);

}  // namespace evbench
