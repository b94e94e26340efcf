#pragma once

#include <string>
#include <vector>

#include "core/events/companions/field.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"

namespace evbench {

/// What calibrations have in common. Every InputError names file and key.

/// A camera as Kalibr writes it: camera_model "pinhole", distortion_model "radtan", "equidistant" or "none" with
/// distortion_coeffs, resolution [width, height], and fx fy cx cy under `intrinsics`.
Camera kalibr_camera(const Field& camera, const std::string& intrinsics = "intrinsics");

/// From the four parts of it; `place` says where they were, for messages.
Camera checked_camera(const std::string& place, const std::vector<double>& intrinsics, DistortionModel distortion,
                      const std::vector<double>& coefficients, const std::vector<double>& resolution);

/// Kalibr's names of lens models.
DistortionModel kalibr_distortion(const std::string& place, const std::string& name);

/// A rigid transformation from 16 numbers of a 4x4 matrix, row by row. The rotation may be off by 1e-3.
SE3 checked_pose(const std::string& place, const double* matrix);

/// From a list of four rows.
SE3 matrix_pose(const Field& rows);

}  // namespace evbench
