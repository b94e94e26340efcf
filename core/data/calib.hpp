#pragma once

#include <string>

#include "core/geometry/camera.hpp"

namespace evbench {

/// Reads the Event-Camera Dataset's calib.txt: one record, `fx fy cx cy k1 k2 p1 p2 k3`. The file holds neither the
/// size of the sensor nor the lens model, so the caller says them [px]; with DistortionModel::equidistant the record is
/// `fx fy cx cy k1 k2 k3 k4`, with none `fx fy cx cy`.
/// Throws InputError for another number of columns or records, a value that is not finite, a focal length ≤ 0.
Camera read_calib(const std::string& path, int width, int height,
                  DistortionModel model = DistortionModel::radial_tangential);

/// The record that read_calib() reads back as the same camera; one without a lens as radial_tangential, all of it 0.
std::string format_calib(const Camera& camera);

}  // namespace evbench
