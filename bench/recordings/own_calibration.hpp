#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/events/reader.hpp"

namespace evbench {

/// Calibration and ground truth of a recording.
struct OwnCalibration {
  std::optional<Camera> calibration;
  std::optional<PoseTrajectory> ground_truth;
  /// "calibration that cannot be used" or "ground truth that ...", as metadata, and why.
  std::vector<std::pair<std::string, std::string>> unusable;
};

/// Gets them from a reader. An error in one of them leaves the events usable, but is an InputError where `strict`.
OwnCalibration own_calibration(EventReader& reader, bool strict);

}  // namespace evbench
