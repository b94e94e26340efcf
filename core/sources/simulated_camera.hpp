#pragma once

#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/plugin/options.hpp"

namespace evbench {

struct SimulatedCameraOptions {
  int width = 240, height = 180;
  double focal_length = 200.0;
  std::string distortion = "none";
  std::vector<double> coefficients;
  std::string calib;

  void declare(OptionSet& set);
};

/// The camera that the options describe: from a calibration file (relative to `folder`), or with its principal point in
/// the middle of the image. Throws InputError, naming `place`, when the number of coefficients does not suit the lens
/// model, the model cannot be inverted at a corner of the image, or the file is no calibration.
Camera make_camera(const SimulatedCameraOptions& options, const std::string& folder, const std::string& place);

}  // namespace evbench
