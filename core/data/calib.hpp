#pragma once

#include <string>

#include "core/geometry/camera.hpp"

namespace evbench {

/// Reads the calibration of a camera: text with one record like the Event-Camera Dataset's calib.txt (`fx fy cx cy` and
/// the coefficients of checked_camera(), k1 k2 p1 p2 k3), or YAML (see yaml_camera()). Size [px] and lens model come
/// from the file, or from the arguments if the file does not give them. `camera` selects one of several cameras by
/// name. Throws InputError for a wrong number of columns or records, a value that is not finite, a focal length ≤ 0, a
/// principal point outside the image, and an unknown lens model.
Camera read_calib(const std::string& path, int width, int height,
                  DistortionModel model = DistortionModel::radial_tangential, const std::string& camera = "");

/// The record that read_calib() reads back as the same camera. A camera without a lens model gets zero coefficients.
std::string format_calib(const Camera& camera);

}  // namespace evbench
