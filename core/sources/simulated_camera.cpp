#include "core/sources/simulated_camera.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/data/calib.hpp"
#include "core/io/path.hpp"
#include "core/support/error.hpp"

namespace evbench {

void SimulatedCameraOptions::declare(OptionSet& set) {
  set.add("width", width, "sensor's width [px]").range(1, 1e4);
  set.add("height", height, "sensor's height [px]").range(1, 1e4);
  set.add("focal_length", focal_length, "focal length [px]; the principal point is the image's middle").above(0.0);
  set.add("distortion", distortion, "lens model of the raw pixels")
      .choices({"none", "radial_tangential", "equidistant"});
  set.add("coefficients", coefficients, "of the lens: k1 k2 p1 p2 k3 (radial_tangential), k1 k2 k3 k4 (equidistant)");
  set.add("calib", calib, "path of a calibration to take instead, as in source recording; empty: none").path();
}

Camera make_camera(const SimulatedCameraOptions& options, const std::string& folder, const std::string& place) {
  Camera camera;
  camera.width = options.width;
  camera.height = options.height;
  camera.pinhole = {options.focal_length, options.focal_length, 0.5 * (options.width - 1), 0.5 * (options.height - 1)};
  camera.distortion = parse_distortion_model(options.distortion);
  if (!options.calib.empty()) {
    camera = read_calib(resolve_path(options.calib, folder), options.width, options.height, camera.distortion);
  } else {
    const std::size_t expected = camera.distortion == DistortionModel::none                ? 0
                                 : camera.distortion == DistortionModel::radial_tangential ? 5
                                                                                           : 4;
    if (options.coefficients.size() != expected) {
      throw InputError(fmt::format("{}.coefficients: has {} numbers; {} expects {}", place, options.coefficients.size(),
                                   options.distortion, expected));
    }
    std::ranges::copy(options.coefficients, camera.coefficients.begin());
  }
  for (const double x : {0.0, camera.width - 1.0}) {
    for (const double y : {0.0, camera.height - 1.0}) {
      if (camera.undistort({x, y})) continue;
      throw InputError(
          fmt::format("{}: the lens bends the rays so far that the corner ({}, {}) sees nothing; expected a lens "
                      "that is invertible over the image",
                      place, x, y));
    }
  }
  return camera;
}

}  // namespace evbench
