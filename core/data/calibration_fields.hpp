#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/io/field.hpp"

namespace evbench {

/// Common parts of calibration files. Every InputError names file and key.

/// Values for what a calibration file does not give.
struct CalibrationDefaults {
  int width = 0, height = 0;  ///< [px]; 0: unknown
  DistortionModel distortion = DistortionModel::none;
};

/// Reads a camera of a YAML file, as written by Kalibr (cam0, cam1, ... of a chain, DSEC's below `intrinsics`, or a
/// single one) or by ROS (camera_info as file or message) and OpenCV (camera_matrix or K, distortion_coefficients or D,
/// image_width or width, ...). `name` selects one of several cameras; empty: the file has one.
Camera yaml_camera(const Field& file, const std::string& name, const CalibrationDefaults& defaults);

/// Reads a camera as Kalibr writes it: camera_model "pinhole", distortion_model with distortion_coeffs, resolution
/// [width, height], and fx fy cx cy under `intrinsics`.
Camera kalibr_camera(const Field& camera, const std::string& intrinsics = "intrinsics");

/// Builds a camera from its parts and checks them; `place` names their place in messages. Without coefficients there is
/// no lens distortion. radial_tangential has k1 k2 p1 p2 and optionally k3, equidistant k1 k2 k3 k4; trailing zeros are
/// accepted. Size [px], 0 if unknown; if known, the principal point must be in the image.
Camera checked_camera(const std::string& place, const std::vector<double>& intrinsics, DistortionModel distortion,
                      const std::vector<double>& coefficients, int width, int height);

/// fx fy cx cy of a camera matrix, row by row: fx 0 cx 0 fy cy 0 0 1.
std::vector<double> matrix_intrinsics(const std::string& place, std::span<const double> K);

/// The lens model of a name that Kalibr or ROS uses.
DistortionModel named_distortion(const std::string& place, const std::string& name);

/// Checks a width or height [px].
int checked_side(const std::string& place, double side);

/// A rigid transformation from the 16 numbers of a 4x4 matrix, row by row. The rotation may deviate by 1e-3.
SE3 checked_pose(const std::string& place, const double* matrix);

/// The same from a list of four rows.
SE3 matrix_pose(const Field& rows);

}  // namespace evbench
