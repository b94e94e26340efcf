#include "backends/gp_map/testing/tracked_scene.hpp"

#include "core/support/json.hpp"

namespace evbench::gp_map::testing {
namespace {

Camera make_camera() {
  Camera camera;
  camera.width = 240;
  camera.height = 180;
  camera.pinhole = {200.0, 200.0, 119.5, 89.5};
  return camera;
}

template <class Options>
Options group(const Json& json, const char* name, Json defaults) {
  if (json.contains(name)) defaults.update(json[name]);
  return read_options<Options>(defaults, name);
}

}  // namespace

TrackedScene::TrackedScene(double duration, const char* options, std::uint64_t seed)
    : duration_(duration), camera_(make_camera()) {
  const Json json = parse_json(options);
  const auto motion_options = group<MotionOptions>(json, "motion", {{"kind", "smooth_random"}});
  const auto scene_options = group<SceneOptions>(json, "scene", {{"kind", "frustum"}});
  const auto track_options = group<TrackOptions>(json, "tracks", Json::object());
  const Motion motion = make_motion(motion_options, duration, seed, ".", "motion");
  Scene scene(scene_options, camera_, motion, duration, Random(seed));
  tracks_ = simulate_tracks(track_options, camera_, motion, scene, duration, seed, "tracks");
  observations_ = undistort({tracks_.observations, {}, duration}, camera_).observations;
  ground_truth_ = sample_motion(motion, duration, 200.0);
}

Run run(const TrackedScene& scene, const RunOptions& options) {
  BackEndContext context;
  context.camera = scene.camera();
  std::vector<StampedPose> causal;
  context.publish = [&](const StampedPose& pose) {  // not those that are published again
    if (causal.empty() || pose.t > causal.back().t) causal.push_back(pose);
  };
  Run result;
  result.backend = std::make_unique<GpMap>(read_options<Options>(parse_json(options.backend), "backend"), context);
  TrackPlayer player = scene.player();
  TrackBatch batch;
  bool more = true;
  for (double t = options.chunk; more; t += options.chunk) {
    more = player.advance({t}, batch);
    result.backend->advance(scene.undistorted(batch));
  }
  result.backend->finish();
  result.causal = PoseTrajectory(std::move(causal));
  const PoseTrajectory own = result.backend->trajectory();
  if (own.empty()) return result;
  std::vector<StampedPose> poses;
  for (double t = own.start(); t <= own.end(); t += 0.01) poses.push_back({t, *result.backend->pose(t)});
  result.scores = score(scene.ground_truth(), PoseTrajectory(std::move(poses)), {.association = "interpolated"});
  return result;
}

}  // namespace evbench::gp_map::testing
