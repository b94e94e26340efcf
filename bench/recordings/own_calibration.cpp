#include "bench/recordings/own_calibration.hpp"

#include "core/events/sensor_size.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {

OwnCalibration own_calibration(EventReader& reader, bool strict) {
  OwnCalibration own;
  const auto ask = [&](const char* key, const auto& read) {
    try {
      read();
    } catch (const InputError& error) {
      check_interruption();
      if (strict) throw;
      own.unusable.emplace_back(key, error.what());
    }
  };
  ask(kUnusableCalibration, [&] {
    const std::optional<Camera> calibration = reader.calibration();
    if (calibration) check_same_sensor("the calibration", *calibration, reader.info());
    own.calibration = calibration;
  });
  ask(kUnusableGroundTruth, [&] { own.ground_truth = reader.ground_truth(); });
  return own;
}

}  // namespace evbench
