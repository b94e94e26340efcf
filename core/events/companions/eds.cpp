#include "core/data/calibration_fields.hpp"
#include "core/events/companions/data_sets.hpp"

namespace evbench {

Companions eds_companions(const EventsPlace& place) {
  Companions found;
  const auto files = place.files;
  const std::string truth = "stamped_groundtruth.txt";
  if (!files->has(truth) && !files->has("images_timestamps.txt")) return found;
  found.sensor = {640, 480, "EDS's (Prophesee Gen3.1)"};
  const auto chains = files->matching("camchain*.yaml");
  if (!chains.empty()) {
    const auto read = [files, chains](int, int) {
      return files->get(only(*files, chains),
                        [](const std::string& path) { return kalibr_camera(Field::read_yaml(path).at("cam1")); });
    };
    found.calibration = {chains, "cam1, EDS's event camera", read};
  }
  if (files->has(truth)) {
    const auto read = [files, truth] {
      return files->get(truth, [](const std::string& path) { return read_poses(path); });
    };
    found.ground_truth = {{truth}, "the event camera", read};
  }
  return found;
}

}  // namespace evbench
