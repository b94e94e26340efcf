#include "core/data/calibration_fields.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/support/error.hpp"
#include "core/support/nearest.hpp"

namespace evbench {
namespace {

/// Accepts zeros after the coefficients of the model: rational_polynomial of ROS and OpenCV has up to 14.
void set_lens(const std::string& place, DistortionModel model, const std::vector<double>& coefficients,
              Camera& camera) {
  const auto fail = [&](const std::string& message) {
    throw InputError(
        fmt::format("{}: {}; expected {}", place, message,
                    model == DistortionModel::equidistant ? "k1 k2 k3 k4" : "k1 k2 p1 p2, or k1 k2 p1 p2 k3"));
  };
  if (coefficients.empty() || model == DistortionModel::none) return;
  const std::size_t most = model == DistortionModel::equidistant ? 4 : 5;
  if (coefficients.size() < 4) fail(fmt::format("has {} lens coefficients", coefficients.size()));
  camera.distortion = model;
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    if (!std::isfinite(coefficients[i])) fail(fmt::format("has lens coefficient {}", coefficients[i]));
    if (i < most) {
      camera.coefficients[static_cast<Eigen::Index>(i)] = coefficients[i];
    } else if (coefficients[i] != 0.0) {
      fail(fmt::format("has {} lens coefficients, of which number {} is {}: a lens model that evbench does not have",
                       coefficients.size(), i + 1, coefficients[i]));
    }
  }
}

/// The value of the first key that exists; none if none does.
std::optional<Field> first_of(const Field& map, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    if (map.has(key)) return map.at(key);
  }
  return std::nullopt;
}

/// The numbers of a list, or of the data of {rows, cols, data}.
std::vector<double> matrix_numbers(const Field& matrix) {
  return (matrix.has("data") ? matrix.at("data") : matrix).numbers();
}

/// Reads a camera as ROS (camera_info, also as a message) and OpenCV write it.
Camera matrix_camera(const Field& camera, const Field& matrix, const CalibrationDefaults& defaults) {
  const std::vector<double> intrinsics = matrix_intrinsics(matrix.place(), matrix_numbers(matrix));
  DistortionModel distortion = defaults.distortion;
  if (camera.has("distortion_model")) {
    const Field model = camera.at("distortion_model");
    distortion = named_distortion(model.place(), model.text());
  } else if (camera.has("fisheye_model") && camera.at("fisheye_model").number() != 0.0) {
    distortion = DistortionModel::equidistant;
  }
  const auto coefficients = first_of(camera, {"distortion_coefficients", "distCoeffs", "dist_coeffs", "D", "d"});
  const auto side = [&](std::initializer_list<const char*> keys, int usual) {
    const auto size = first_of(camera, keys);
    return size ? checked_side(size->place(), size->number()) : usual;
  };
  return checked_camera(
      camera.place(), intrinsics, distortion, coefficients ? matrix_numbers(*coefficients) : std::vector<double>{},
      side({"image_width", "width"}, defaults.width), side({"image_height", "height"}, defaults.height));
}

Camera single_camera(const Field& camera, const CalibrationDefaults& defaults) {
  if (camera.has("camera_model"))
    return kalibr_camera(camera, camera.has("intrinsics") ? "intrinsics" : "camera_matrix");
  if (const auto matrix = first_of(camera, {"camera_matrix", "cameraMatrix", "K", "k"})) {
    return matrix_camera(camera, *matrix, defaults);
  }
  camera.fail("is no camera; expected camera_model and intrinsics (Kalibr), or camera_matrix (ROS, OpenCV)");
}

std::vector<std::string> camera_names(const Field& cameras) {
  std::vector<std::string> names = cameras.keys();
  std::erase_if(names, [&](const std::string& key) { return !cameras.at(key).has("camera_model"); });
  return names;
}

}  // namespace

Camera checked_camera(const std::string& place, const std::vector<double>& intrinsics, DistortionModel distortion,
                      const std::vector<double>& coefficients, int width, int height) {
  Camera camera;
  camera.pinhole = {intrinsics.at(0), intrinsics.at(1), intrinsics.at(2), intrinsics.at(3)};
  for (const double number : intrinsics) {
    if (!std::isfinite(number) || !(intrinsics[0] > 0.0 && intrinsics[1] > 0.0)) {
      throw InputError(fmt::format("{}: has fx fy cx cy {} {} {} {}; expected numbers, the first two > 0 px", place,
                                   intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3]));
    }
  }
  const PinholeCamera& p = camera.pinhole;
  constexpr double kLeastFocalLength = 10.0;  // [px]; that of coordinates normalised to 0..1 is about 1
  if (p.fx < kLeastFocalLength || p.fy < kLeastFocalLength || p.cx < 0.0 || p.cy < 0.0) {
    throw InputError(fmt::format("{}: has fx fy cx cy {} {} {} {}; expected pixels of the image, not shares of it",
                                 place, p.fx, p.fy, p.cx, p.cy));
  }
  camera.width = width;
  camera.height = height;
  const bool known = width > 0 && height > 0;
  if (known && !camera.contains({camera.pinhole.cx, camera.pinhole.cy})) {
    throw InputError(
        fmt::format("{}: has the principal point ({}, {}), outside the image of {}x{} pixels; expected it "
                    "inside, and width and height of this camera",
                    place, camera.pinhole.cx, camera.pinhole.cy, width, height));
  }
  set_lens(place, distortion, coefficients, camera);
  return camera;
}

std::vector<double> matrix_intrinsics(const std::string& place, std::span<const double> K) {
  if (K.size() != 9 || K[1] != 0.0 || K[3] != 0.0 || K[6] != 0.0 || K[7] != 0.0 || K[8] != 1.0) {
    throw InputError(fmt::format("{}: is no camera matrix; expected fx 0 cx 0 fy cy 0 0 1", place));
  }
  return {K[0], K[4], K[2], K[5]};
}

DistortionModel named_distortion(const std::string& place, const std::string& name) {
  const auto is = [&](std::initializer_list<const char*> names) {
    return std::ranges::any_of(names, [&](const char* known) { return name == known; });
  };
  if (is({"radtan", "plumb_bob", "rational_polynomial"})) return DistortionModel::radial_tangential;
  if (is({"equidistant", "equi", "fisheye", "kannala_brandt", "kannala_brandt4"})) return DistortionModel::equidistant;
  if (is({"none", ""})) return DistortionModel::none;
  throw InputError(
      fmt::format("{}: is \"{}\"; expected radtan, equidistant or none (plumb_bob, "
                  "rational_polynomial or fisheye of ROS)",
                  place, name));
}

int checked_side(const std::string& place, double side) {
  if (!(side >= 1.0 && side <= 65536.0 && side == std::floor(side))) {
    throw InputError(fmt::format("{}: has a resolution of {} px; expected 1 to 65536", place, side));
  }
  return static_cast<int>(side);
}

Camera kalibr_camera(const Field& camera, const std::string& intrinsics) {
  const Field model = camera.at("camera_model"), lens = camera.at("distortion_model");
  if (model.text() != "pinhole") model.fail(fmt::format("is \"{}\"; expected pinhole", model.text()));
  const DistortionModel distortion = named_distortion(lens.place(), lens.text());
  std::vector<double> coefficients;
  if (distortion != DistortionModel::none) coefficients = camera.at("distortion_coeffs").numbers(4);
  const std::vector<double> size = camera.at("resolution").numbers(2);
  return checked_camera(camera.place(), camera.at(intrinsics).numbers(4), distortion, coefficients,
                        checked_side(camera.place(), size[0]), checked_side(camera.place(), size[1]));
}

Camera yaml_camera(const Field& file, const std::string& name, const CalibrationDefaults& defaults) {
  const Field cameras = file.has("intrinsics") && file.at("intrinsics").is_map() ? file.at("intrinsics") : file;
  const auto names = camera_names(cameras);
  if (names.empty() && name.empty()) return single_camera(file, defaults);
  if (name.empty() && names.size() > 1) {
    cameras.fail(fmt::format("holds {}; expected the name of one of them (option camera)", fmt::join(names, ", ")));
  }
  if (!name.empty() && std::ranges::find(names, name) == names.end()) {
    cameras.fail(fmt::format("has no camera \"{}\"{}", name, suggestion(name, names)));
  }
  return single_camera(cameras.at(name.empty() ? names.front() : name), defaults);
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
