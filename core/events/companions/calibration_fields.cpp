#include "core/events/companions/calibration_fields.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "core/support/error.hpp"

namespace evbench {

Camera checked_camera(const std::string& place, const std::vector<double>& intrinsics, DistortionModel distortion,
                      const std::vector<double>& coefficients, const std::vector<double>& resolution) {
  Camera camera;
  camera.pinhole = {intrinsics.at(0), intrinsics.at(1), intrinsics.at(2), intrinsics.at(3)};
  for (const double number : intrinsics) {
    if (!std::isfinite(number) || !(intrinsics[0] > 0.0 && intrinsics[1] > 0.0)) {
      throw InputError(fmt::format("{}: has fx fy cx cy {} {} {} {}; expected numbers, the first two > 0 px", place,
                                   intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3]));
    }
  }
  camera.distortion = distortion;
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    if (!std::isfinite(coefficients[i])) {
      throw InputError(fmt::format("{}: has lens coefficient {}; expected a number", place, coefficients[i]));
    }
    camera.coefficients[static_cast<Eigen::Index>(i)] = coefficients[i];
  }
  for (const double side : resolution) {
    if (!(side >= 1.0 && side <= 65536.0 && side == std::floor(side))) {
      throw InputError(fmt::format("{}: has a resolution of {} px; expected 1 to 65536", place, side));
    }
  }
  camera.width = static_cast<int>(resolution.at(0));
  camera.height = static_cast<int>(resolution.at(1));
  return camera;
}

DistortionModel kalibr_distortion(const std::string& place, const std::string& name) {
  if (name == "radtan") return DistortionModel::radial_tangential;
  if (name == "equidistant") return DistortionModel::equidistant;
  if (name == "none") return DistortionModel::none;
  throw InputError(fmt::format("{}: is \"{}\"; expected radtan, equidistant or none", place, name));
}

Camera kalibr_camera(const Field& camera, const std::string& intrinsics) {
  const Field model = camera.at("camera_model"), lens = camera.at("distortion_model");
  if (model.text() != "pinhole") model.fail(fmt::format("is \"{}\"; expected pinhole", model.text()));
  const DistortionModel distortion = kalibr_distortion(lens.place(), lens.text());
  std::vector<double> coefficients;
  if (distortion != DistortionModel::none) coefficients = camera.at("distortion_coeffs").numbers(4);
  return checked_camera(camera.place(), camera.at(intrinsics).numbers(4), distortion, coefficients,
                        camera.at("resolution").numbers(2));
}

SE3 checked_pose(const std::string& place, const double* matrix) {
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> T(matrix);
  const Matrix3 R = T.topLeftCorner<3, 3>();
  if (!T.allFinite() || !(R * R.transpose()).isIdentity(1e-3) || R.determinant() < 0.0) {
    throw InputError(fmt::format("{}: is no pose; expected a 4x4 matrix of a rotation and a translation", place));
  }
  return {Eigen::Quaterniond(R).normalized(), T.topRightCorner<3, 1>()};
}

SE3 matrix_pose(const Field& rows) {
  std::vector<double> matrix;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto row = rows.at(i).numbers(4);
    matrix.insert(matrix.end(), row.begin(), row.end());
  }
  return checked_pose(rows.place(), matrix.data());
}

}  // namespace evbench
