#include "core/data/calibration_fields.hpp"
#include "core/events/companions/data_sets.hpp"

namespace evbench {

Companions dsec_companions(const EventsPlace& place) {
  Companions found;
  const auto files = place.files;
  const std::string camera = place.right ? "cam3" : "cam0";
  for (const std::string name : {"cam_to_cam.yaml", "calibration/cam_to_cam.yaml"}) {
    if (!files->has(name)) continue;
    const auto read = [files, name, camera](int, int) {
      return files->get(name, [&](const std::string& path) {
        return kalibr_camera(Field::read_yaml(path).at("intrinsics").at(camera), "camera_matrix");
      });
    };
    found.calibration = {{name}, camera + (place.right ? ", DSEC's right" : ", DSEC's left") + " event camera", read};
    break;
  }
  return found;
}

}  // namespace evbench
