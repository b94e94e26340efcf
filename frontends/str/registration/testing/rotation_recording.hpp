#pragma once

#include <string>
#include <vector>

#include "core/events/event.hpp"
#include "core/geometry/camera.hpp"

namespace evbench::str::testing {

/// Events of a camera that rotates at a constant body velocity before a scene.
struct RotationRecording {
  Camera camera;
  Vector3 omega;  ///< [rad/s]
  std::vector<Event> events;
};

/// Simulated: `scene` as in RenderedSceneOptions::kind, an image of this size [px], the focal length 5/6 of the width;
/// thresholds 0.3.
RotationRecording simulate_rotation(const std::string& scene, int width, int height, const Vector3& omega,
                                    double duration, std::uint64_t seed);

}  // namespace evbench::str::testing
