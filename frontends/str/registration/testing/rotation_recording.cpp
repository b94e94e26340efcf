#include "frontends/str/registration/testing/rotation_recording.hpp"

#include "core/geometry/so3.hpp"
#include "core/simulation/events/event_simulator.hpp"
#include "core/simulation/events/scene_brightness.hpp"

namespace evbench::str::testing {

RotationRecording simulate_rotation(const std::string& scene, int width, int height, const Vector3& omega,
                                    double duration, std::uint64_t seed) {
  RotationRecording result{{}, omega, {}};
  Camera& camera = result.camera;
  camera.width = width;
  camera.height = height;
  const double focal_length = 5.0 * width / 6.0;
  camera.pinhole = {focal_length, focal_length, 0.5 * (camera.width - 1), 0.5 * (camera.height - 1)};
  const Motion motion = [omega, duration](double t) {
    return SE3{so3::exp((t - 0.5 * duration) * omega), Vector3::Zero()};
  };
  RenderedSceneOptions options;
  options.kind = scene;
  const auto rendered = std::make_shared<const RenderedScene>(
      make_rendered_scene(options, camera, motion, duration, Random(seed), "", "scene"));
  SimulatorOptions simulator;
  simulator.sensor.threshold_on = simulator.sensor.threshold_off = 0.3;
  EventSimulator events(std::make_unique<SceneBrightness>(camera, rendered, motion, RenderingOptions{}, 2), simulator,
                        duration, seed);
  for (std::vector<Event> chunk; events.read(chunk);) {
    result.events.insert(result.events.end(), chunk.begin(), chunk.end());
  }
  return result;
}

}  // namespace evbench::str::testing
