#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/io/field.hpp"

namespace evbench {

/// What calibrations have in common. Every InputError names file and key.

/// What a file may leave unsaid.
struct CalibrationDefaults {
  int width = 0, height = 0;  ///< [px]; 0: unknown
  DistortionModel distortion = DistortionModel::none;
};

/// A camera of a YAML file. Of Kalibr (a chain's cam0, cam1, ..., likewise DSEC's below `intrinsics`, or one alone); as
/// ROS (camera_info's file or message) and OpenCV write it: camera_matrix or K, distortion_coefficients or D,
/// image_width or width, ... `name`: which one of several; empty: there is one.
Camera yaml_camera(const Field& file, const std::string& name, const CalibrationDefaults& defaults);

/// A camera as Kalibr writes it: camera_model "pinhole", distortion_model with distortion_coeffs, resolution [width,
/// height], and fx fy cx cy under `intrinsics`.
Camera kalibr_camera(const Field& camera, const std::string& intrinsics = "intrinsics");

/// From the parts of it; `place` says where they were, for messages. Without coefficients there is no lens;
/// radial_tangential has k1 k2 p1 p2 and perhaps k3, equidistant k1 k2 k3 k4, both perhaps zeros behind them. Size
/// [px], 0 where it is unknown: otherwise the principal point must be in the image.
Camera checked_camera(const std::string& place, const std::vector<double>& intrinsics, DistortionModel distortion,
                      const std::vector<double>& coefficients, int width, int height);

/// fx fy cx cy of a camera matrix, row by row: fx 0 cx 0 fy cy 0 0 1.
std::vector<double> matrix_intrinsics(const std::string& place, std::span<const double> K);

/// The names that Kalibr and ROS have for lens models.
DistortionModel named_distortion(const std::string& place, const std::string& name);

/// Width or height [px].
int checked_side(const std::string& place, double side);

/// A rigid transformation from 16 numbers of a 4x4 matrix, row by row. The rotation may be off by 1e-3.
SE3 checked_pose(const std::string& place, const double* matrix);

/// From a list of four rows.
SE3 matrix_pose(const Field& rows);

}  // namespace evbench
