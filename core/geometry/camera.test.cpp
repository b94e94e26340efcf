#include "core/geometry/camera.hpp"

#include <Eigen/Geometry>

#include "core/simulation/random.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

Camera davis(DistortionModel model) {
  Camera camera;
  camera.pinhole = {199.09, 198.83, 132.19, 110.71};
  camera.width = 240;
  camera.height = 180;
  camera.distortion = model;
  if (model == DistortionModel::radial_tangential) camera.coefficients << -0.3684, 0.1509, -0.0003, -0.00076, 0.0;
  if (model == DistortionModel::equidistant) camera.coefficients << -0.048, 0.011, -0.005, 0.0008, 0.0;
  return camera;
}

}  // namespace

TEST_CASE("Undistortion inverts distortion over the whole image") {
  const DistortionModel model =
      GENERATE(DistortionModel::none, DistortionModel::radial_tangential, DistortionModel::equidistant);
  const Camera camera = davis(model);
  for (int x = 0; x < camera.width; x += 3) {
    for (int y = 0; y < camera.height; y += 3) {
      const Vector2 raw(x, y);
      const std::optional<Vector2> ideal = camera.undistort(raw);
      REQUIRE(ideal);
      REQUIRE((camera.project(2.5 * camera.pinhole.ray(*ideal)) - raw).norm() < 1e-9);
    }
  }
}

TEST_CASE("The lens distortion is zero at the centre and largest at the border") {
  const Camera camera = davis(DistortionModel::radial_tangential);
  const Vector2 centre(camera.pinhole.cx, camera.pinhole.cy);
  CHECK((*camera.undistort(centre) - centre).norm() < 1e-9);
  CHECK((*camera.undistort({0.0, 0.0}) - Vector2(0.0, 0.0)).norm() > 5.0);
}

TEST_CASE("A pixel outside the range of the lens model has no undistorted pixel") {
  Camera folding = davis(DistortionModel::radial_tangential);
  folding.coefficients << -0.3, 0.0, 0.0, 0.0, 0.0;  // r (1 - 0.3 r²) decreases beyond r = 1.05
  CHECK_FALSE(folding.undistort({500.0, 500.0}));
  CHECK_FALSE(davis(DistortionModel::equidistant).undistort({5000.0, 5000.0}));
}

TEST_CASE("The Jacobian of the distortion equals central differences, and is exactly 1 without a lens") {
  constexpr double kStep = 1e-4;  // [px]
  for (const DistortionModel model : {DistortionModel::radial_tangential, DistortionModel::equidistant}) {
    const Camera camera = davis(model);
    const auto raw = [&](const Vector2& ideal) { return camera.project(camera.pinhole.ray(ideal)); };
    for (const Vector2& ideal : {Vector2(10.0, 15.0), Vector2(130.0, 110.0), Vector2(220.0, 40.0)}) {
      Matrix2 differences;
      for (Eigen::Index axis = 0; axis < 2; ++axis) {
        const Vector2 step = kStep * Vector2::Unit(axis);
        differences.col(axis) = (raw(ideal + step) - raw(ideal - step)) / (2.0 * kStep);
      }
      CHECK((camera.distortion_jacobian(ideal) - differences).norm() < 1e-6);
    }
  }
  CHECK(davis(DistortionModel::none).distortion_jacobian({10.0, 15.0}) == Matrix2::Identity());
}

TEST_CASE("The Jacobian of the projection equals central differences") {
  const PinholeCamera camera = davis(DistortionModel::none).pinhole;
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vector3 point = random.uniform3({-2, -2, 0.3}, {2, 2, 5});
    Matrix23 differences;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double h = 1e-5 * point.z();
      const Vector3 step = h * Vector3::Unit(axis);
      differences.col(axis) = (camera.project(point + step) - camera.project(point - step)) / (2.0 * h);
    }
    const Matrix23 jacobian = camera.project_jacobian(point);
    REQUIRE((jacobian - differences).norm() < 1e-6 * (1.0 + jacobian.norm()));
  }
}

TEST_CASE("Names of distortion models are read and written, and unknown ones are refused") {
  for (const char* name : {"none", "radial_tangential", "equidistant"}) {
    CHECK(to_string(parse_distortion_model(name)) == name);
  }
  CHECK_THROWS_AS(parse_distortion_model("fisheye"), InputError);
}
