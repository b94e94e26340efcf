#include "core/data/calib.hpp"
#include "core/events/companions/data_sets.hpp"

namespace evbench {

Companions ecd_companions(const EventsPlace& place) {
  Companions found;
  const auto files = place.files;
  if (files->has("calib.txt")) {
    const auto read = [files](int width, int height) {
      return files->get("calib.txt", [&](const std::string& path) { return read_calib(path, width, height); });
    };
    found.calibration = {{"calib.txt"}, "as in the Event-Camera Dataset", read};
  }
  if (files->has("groundtruth.txt")) {
    const auto read = [files] {
      return files->get("groundtruth.txt", [](const std::string& path) { return read_poses(path); });
    };
    found.ground_truth = {{"groundtruth.txt"}, "the camera", read};
  }
  return found;
}

}  // namespace evbench
