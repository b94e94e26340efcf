#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/events/reader.hpp"

namespace evbench {

/// What a recording has beside its events.
struct OwnCalibration {
  std::optional<Camera> calibration;
  std::optional<PoseTrajectory> ground_truth;
  /// "calibration that cannot be used" or "ground truth that ...", as metadata, and why.
  std::vector<std::pair<std::string, std::string>> unusable;
};

/// Asks a reader. What is wrong with one does not keep the events from being used, but is an InputError where `strict`.
OwnCalibration own_calibration(EventReader& reader, bool strict);

}  // namespace evbench
