#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "backends/gp_map/testing/tracked_scene.hpp"

namespace evbench::gp_map {
namespace {

using testing::TrackedScene;

constexpr double kMisled = 0.4;  ///< [s]

/// Up to kMisled each track is as if its point were elsewhere on its ray of that moment, nearer or farther off, and the
/// camera came from the other side: a first map from there fits nothing that is seen later.
std::vector<TrackObservation> misleading(const TrackedScene& scene) {
  const SE3 T = *scene.ground_truth().pose(kMisled);
  std::vector<TrackObservation> observations;
  for (TrackObservation z : scene.observations()) {
    if (z.t < kMisled) {
      const SE3 T_camera_world = scene.ground_truth().pose(z.t)->inverse();
      const SE3 mirrored = T * (T_camera_world * T);
      const Vector3 point = scene.point(z.track);
      const double farther = z.track % 2 == 0 ? 0.4 : 2.5;
      const Vector3 elsewhere = T * (farther * (T.inverse() * point));
      z.pixel +=
          scene.camera().project(mirrored.inverse() * elsewhere) - scene.camera().project(T_camera_world * point);
    }
    observations.push_back(z);
  }
  return observations;
}

}  // namespace

TEST_CASE("A first map that has no place for most of what is seen next makes way for another one") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const TrackedScene scene(5.0, R"({"tracks": {"lifetime": [60, 60]}})", seed);
    std::string log;
    BackEndContext context;
    context.camera = scene.camera();
    context.log = [&](const std::string& line) { log += line + "\n"; };
    GpMap backend({}, context);
    const std::vector<TrackObservation> observations = misleading(scene);
    backend.advance({observations, {}, scene.duration()});
    backend.finish();
    INFO(log);
    CHECK(log.find("another one is looked for") != std::string::npos);
    CHECK(backend.status().state == RunState::ok);
    const PoseTrajectory trajectory = backend.trajectory();
    REQUIRE_FALSE(trajectory.empty());
    CHECK(trajectory.start() < 1.0);
    CHECK(score(scene.ground_truth(), trajectory, {.association = "interpolated"}).ate.trans_percent < 1.0);
  }
}

}  // namespace evbench::gp_map
