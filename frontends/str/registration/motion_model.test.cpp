#include "frontends/str/registration/motion_model.hpp"

#include "core/geometry/so3.hpp"
#include "core/testing/catch2.hpp"
#include "frontends/str/registration/event_cloud.hpp"

using namespace evbench;
using namespace evbench::str;

TEST_CASE("Events are moved as the rays of a camera that rotates") {
  const Vector3 omega(3.0, -5.0, 2.0);
  EventCloud cloud;
  for (const double t : {-0.03, -0.01, 0.0, 0.02}) {
    for (const double x : {-0.6, 0.0, 0.5}) cloud.add(static_cast<float>(x), 0.3F, static_cast<float>(t), true);
  }
  std::vector<float> x, y;
  warp(cloud, generator_matrix(MotionModel::rotation, omega), x, y);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3 ray(static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]), 1.0);
    const Vector3 expected = so3::exp(static_cast<double>(cloud.t[i]) * omega) * ray;
    CHECK(x[i] == Approx(expected.x() / expected.z()).margin(2e-6));
    CHECK(y[i] == Approx(expected.y() / expected.z()).margin(2e-6));
  }
}

TEST_CASE("A planar motion of constant depth is one of four parameters, and every motion one of eight") {
  MotionParameters theta(4);
  theta << 0.3, -0.2, 0.5, 0.1;
  const Matrix3 A = generator_matrix(MotionModel::planar_4, theta);
  CHECK((project_onto(MotionModel::planar_4, A) - theta).norm() < 1e-12);
  const Matrix3 eight = generator_matrix(MotionModel::planar_8, project_onto(MotionModel::planar_8, A));
  CHECK((eight - A).norm() < 1e-12);
  // A multiple of the identity moves nothing.
  CHECK((project_onto(MotionModel::planar_8, A + 0.7 * Matrix3::Identity()) - project_onto(MotionModel::planar_8, A))
            .norm() < 1e-12);
  const Vector3 omega(1.0, 2.0, 3.0);
  const Matrix3 rotation = generator_matrix(MotionModel::rotation, omega);
  CHECK((rotation - so3::hat(omega)).norm() < 1e-15);
  CHECK((project_onto(MotionModel::rotation, rotation) - omega).norm() < 1e-12);
}
