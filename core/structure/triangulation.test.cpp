#include "core/structure/triangulation.hpp"

#include <limits>
#include <vector>

#include "core/testing/catch2.hpp"
#include "core/testing/point_scene.hpp"

using namespace evbench;
using evbench::testing::davis;
using State = Triangulation::State;

namespace {

std::vector<SE3> to_the_side(int count, double baseline) {
  std::vector<SE3> poses;
  for (int i = 0; i < count; ++i) {
    poses.push_back(se3::exp((Vector6() << 0.0, -0.02 * i, 0.0, baseline * i, 0.1 * baseline * i, 0.0).finished()));
  }
  return poses;
}

std::vector<Vector2> pixels_of(const Vector3& point, const std::vector<SE3>& poses) {
  std::vector<Vector2> pixels;
  for (const SE3& T : poses) pixels.push_back(davis().project(T.inverse() * point));
  return pixels;
}

}  // namespace

TEST_CASE("a point is triangulated exactly from exact pixels") {
  const Vector3 point(0.3, -0.2, 2.5);
  for (const int views : {2, 3, 10}) {
    const auto poses = to_the_side(views, 0.1);
    const Triangulation result = triangulate(poses, pixels_of(point, poses), davis());
    REQUIRE(result.ok());
    CHECK((result.point - point).norm() < 1e-9);
    CHECK(result.rms_px < 1e-6);
    CHECK(result.min_depth > 2.0);
    CHECK(result.parallax_deg > 2.0);
  }
}

TEST_CASE("a point is triangulated from noisy pixels to the accuracy that the baseline allows") {
  Random random(1);
  const Vector3 point(0.3, -0.2, 2.5);
  const auto poses = to_the_side(20, 0.05);
  auto pixels = pixels_of(point, poses);
  for (Vector2& pixel : pixels) pixel += testing::noise(0.7, random);
  const Triangulation result = triangulate(poses, pixels, davis());
  REQUIRE(result.ok());
  CHECK((result.point - point).norm() < 0.05);
  CHECK(result.rms_px == Approx(1.0).epsilon(0.4));
}

TEST_CASE("a failed triangulation gives its reason") {
  const auto poses = to_the_side(3, 0.1);
  const Vector3 point(0.3, -0.2, 2.5);
  SECTION("one view") {
    CHECK(triangulate(std::span(poses).first(1), pixels_of(point, to_the_side(1, 0.1)), davis()).state ==
          State::too_few_views);
  }
  SECTION("a point at infinity") {
    CHECK(triangulate(poses, pixels_of(1e7 * point, poses), davis()).state == State::low_parallax);
  }
  SECTION("rays that meet behind the cameras") {
    CHECK(triangulate(poses, pixels_of(-point, poses), davis()).state == State::behind_camera);
  }
  SECTION("NaN") {
    auto pixels = pixels_of(point, poses);
    pixels[1].x() = std::numeric_limits<double>::quiet_NaN();
    CHECK(triangulate(poses, pixels, davis()).state == State::not_finite);
  }
  SECTION("rays that don't meet") {
    auto pixels = pixels_of(point, poses);
    pixels[1].y() += 30.0;
    CHECK(triangulate(poses, pixels, davis()).state == State::large_error);
  }
  SECTION("identical views without a parallax test") {
    TriangulationOptions options;
    options.min_parallax_deg = 0.0;
    const std::vector<SE3> same(3);
    const Triangulation result = triangulate(same, pixels_of(point, same), davis(), options);
    CHECK(result.point.allFinite());
  }
}
