#include "bench/render/motion_compensation.hpp"

#include <cmath>

#include "core/geometry/so3.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

constexpr int kSteps = 100;  // of 1 ms

Camera lens_camera() {
  Camera camera;
  camera.pinhole = {100.0, 100.0, 60.0, 45.0};
  camera.distortion = DistortionModel::radial_tangential;
  camera.coefficients << -0.2, 0.05, 0.001, -0.001, 0.0;
  camera.width = 120;
  camera.height = 90;
  return camera;
}

/// Turns by 1 rad/s about an axis that is no axis of the camera, and slides by `speed` along x, y and z.
PoseTrajectory moving(const Vector3& speed) {
  std::vector<StampedPose> poses;
  for (int i = 0; i <= kSteps; ++i) {
    const double t = 1e-3 * i;
    poses.push_back({t, {so3::exp(t * Vector3(0.36, 0.48, 0.8)), t * speed}});
  }
  return PoseTrajectory(std::move(poses));
}

/// Events of 60 points, each at the nearest pixel once a millisecond; on and off in turn.
std::vector<Event> see(const std::vector<Vector3>& points, const PoseTrajectory& trajectory, const Camera& camera) {
  std::vector<Event> events;
  for (const StampedPose& pose : trajectory.poses()) {
    bool on = true;
    for (const Vector3& point : points) {
      const Vector2 pixel = camera.project(pose.T.inverse() * point);
      on = !on;
      if (!camera.contains(pixel)) continue;
      events.push_back({std::llround(pose.t * 1e6), static_cast<std::uint16_t>(std::lround(pixel.x())),
                        static_cast<std::uint16_t>(std::lround(pixel.y())), on});
    }
  }
  return events;
}

/// Points on the plane z = depth of the camera in the middle of the trajectory.
std::vector<Vector3> points_on_plane(const PoseTrajectory& trajectory, double depth) {
  const SE3 T = trajectory.poses()[kSteps / 2].T;
  std::vector<Vector3> points;
  for (int i = 0; i < 60; ++i) points.push_back(T * (depth * Vector3(0.1 * (i % 10 - 4.5), 0.12 * (i / 10 - 2.5), 1)));
  return points;
}

double variance(const cv::Mat1f& image) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  return deviation[0] * deviation[0];
}

double variance(const PolarityCounts& counts) { return variance(counts.on) + variance(counts.off); }

PolarityCounts uncompensated(const std::vector<Event>& events, const Camera& camera) {
  const cv::Size size(camera.width, camera.height);
  PolarityCounts counts{cv::Mat1f(size, 0.0F), cv::Mat1f(size, 0.0F)};
  for (const Event& event : events) (event.on ? counts.on : counts.off)(event.y, event.x) += 1.0F;
  return counts;
}

}  // namespace

TEST_CASE("Compensation of a rotation moves a point's events to its pixel at the reference time") {
  const Camera camera = lens_camera();
  const PoseTrajectory trajectory = moving(Vector3::Zero());
  const std::vector<Vector3> points = points_on_plane(trajectory, 1.0);
  const std::vector<Event> events = see(points, trajectory, camera);
  const PolarityCounts counts = MotionCompensation(trajectory, camera, {}, "motion").accumulate(events, 50000);
  CHECK(variance(counts) > 2.0 * variance(uncompensated(events, camera)));

  const Vector2 pixel = camera.project(trajectory.poses()[kSteps / 2].T.inverse() * points[25]);
  const cv::Rect around(static_cast<int>(std::lround(pixel.x())) - 1, static_cast<int>(std::lround(pixel.y())) - 1, 3,
                        3);
  CHECK(cv::sum(counts.on(around))[0] + cv::sum(counts.off(around))[0] == Approx(kSteps + 1).margin(2));
}

TEST_CASE("Compensation of a translation is sharpest at the right depth") {
  const Camera camera = lens_camera();
  const PoseTrajectory trajectory = moving({2.0, -1.0, 0.5});
  const std::vector<Event> events = see(points_on_plane(trajectory, 2.0), trajectory, camera);
  const auto sharpness = [&](std::optional<double> depth) {
    return variance(MotionCompensation(trajectory, camera, depth, "motion").accumulate(events, 50000));
  };
  CHECK(sharpness(2.0) > 3.0 * sharpness({}));
  CHECK(sharpness(2.0) > 1.5 * sharpness(1.6));
  CHECK(sharpness(2.0) > 1.5 * sharpness(2.5));
}

TEST_CASE("Without motion events stay at their pixels, and the trajectory's clock may have another zero") {
  const Camera camera = lens_camera();
  const PoseTrajectory still(std::vector<StampedPose>{{100.0, {}}, {101.0, {}}});
  const std::vector<Event> events{{0, 17, 31, true}, {500, 100, 70, false}};
  const PolarityCounts counts = MotionCompensation(still, camera, {}, "motion").accumulate(events, 250, 100'000'000);
  CHECK(counts.on(31, 17) == Approx(1.0).margin(1e-6));
  CHECK(counts.off(70, 100) == Approx(1.0).margin(1e-6));
  CHECK(cv::sum(counts.on)[0] == Approx(1.0));
}

TEST_CASE("A trajectory that does not reach an event is refused with both times") {
  const PoseTrajectory trajectory = moving(Vector3::Zero());
  const MotionCompensation compensation(trajectory, lens_camera(), {}, "motion.txt");
  const std::vector<Event> events{{100001, 17, 31, true}};
  CHECK_THROWS_WITH(compensation.accumulate(events, 50000), Catch::Matchers::ContainsSubstring("motion.txt") &&
                                                                Catch::Matchers::ContainsSubstring("0.100001 s"));
}

TEST_CASE("Higher counts are drawn stronger, in the mixed colour of their polarities") {
  const Palette palette = light_palette();
  PolarityCounts counts{cv::Mat1f(1, 4, 0.0F), cv::Mat1f(1, 4, 0.0F)};
  counts.on(0, 1) = counts.off(0, 2) = 4.0F;
  counts.on(0, 3) = counts.off(0, 3) = 1.0F;
  const Picture picture = draw_counts(counts, palette);
  CHECK(picture(0, 0) == palette.background);
  CHECK(picture(0, 1) == palette.on);
  CHECK(picture(0, 2) == palette.off);
  CHECK(picture(0, 3) == blend(palette.background, blend(palette.on, palette.off, 0.5), 0.5));
}
