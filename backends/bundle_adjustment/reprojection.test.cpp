#include "backends/bundle_adjustment/reprojection.hpp"

#include "core/testing/catch2.hpp"
#include "core/testing/differences.hpp"
#include "core/testing/point_scene.hpp"

using namespace evbench;
using namespace evbench::bundle_adjustment;
using evbench::testing::central_differences;
using evbench::testing::davis;
using evbench::testing::relative_error;

TEST_CASE("Jacobians of the reprojection error agree with central differences") {
  testing::RandomTangents random;
  for (int i = 0; i < 1000; ++i) {
    const SE3 T = se3::exp(random.tangent(i));
    const Vector3 landmark = T * Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(1, 4));
    const Vector2 pixel(random.uniform(0, 240), random.uniform(0, 180));
    ReprojectionJacobians J;
    const Vector2 error = reprojection_error(T, landmark, pixel, davis(), J);
    CHECK(error.isApprox(reprojection_error(T, landmark, pixel, davis())));
    CHECK(relative_error(J.pose, central_differences<2, 6>([&](const Vector6& delta) {
                           return reprojection_error(T * se3::exp(delta), landmark, pixel, davis());
                         })) < 1e-6);
    CHECK(relative_error(J.landmark, central_differences<2, 3>([&](const Vector3& delta) {
                           return reprojection_error(T, Vector3(landmark + delta), pixel, davis());
                         })) < 1e-6);
  }
}

TEST_CASE("a landmark behind the camera has a constant error and zero Jacobians") {
  ReprojectionJacobians J;
  const Vector2 error = reprojection_error(SE3{}, Vector3(0.1, 0.2, -1.0), Vector2(100, 80), davis(), J);
  CHECK(error == Vector2::Constant(2.0 * davis().fx));
  CHECK(J.pose.isZero());
  CHECK(J.landmark.isZero());
}

TEST_CASE("a pose is the same after its conversion to a block and back") {
  const SE3 T = se3::exp((Vector6() << 0.1, -0.7, 0.3, 1, 2, 3).finished());
  CHECK(PoseBlock(T).pose().q.coeffs().isApprox(T.q.coeffs()));
  CHECK(PoseBlock(T).pose().p == T.p);
}

TEST_CASE("the pose manifold moves by the right increment, and Minus undoes Plus") {
  const PoseManifold manifold;
  const SE3 T = se3::exp((Vector6() << 0.1, -0.7, 0.3, 1, 2, 3).finished());
  const Vector6 delta = (Vector6() << 0.2, 0.1, -0.3, 0.5, -0.4, 0.1).finished();
  const PoseBlock x(T);
  PoseBlock moved;
  Vector6 back;
  REQUIRE(manifold.Plus(x.values, delta.data(), moved.values));
  CHECK(moved.pose().p.isApprox((T * se3::exp(delta)).p));
  REQUIRE(manifold.Minus(moved.values, x.values, back.data()));
  CHECK(back.isApprox(delta));
}

TEST_CASE("the scale anchor keeps its distance, and Minus undoes Plus") {
  const Vector3 centre(0.5, -0.2, 0.1);
  const FixedDistanceManifold manifold(centre);
  const SE3 T = se3::exp((Vector6() << 0.1, -0.7, 0.3, 1, 2, 3).finished());
  const Eigen::Matrix<double, 5, 1> delta(0.2, 0.1, -0.3, 0.5, -0.4);
  const PoseBlock x(T);
  PoseBlock moved;
  Eigen::Matrix<double, 5, 1> back;
  REQUIRE(manifold.Plus(x.values, delta.data(), moved.values));
  CHECK((moved.pose().p - centre).norm() == Approx((T.p - centre).norm()));
  CHECK((moved.pose().p - T.p).norm() > 0.3);
  REQUIRE(manifold.Minus(moved.values, x.values, back.data()));
  CHECK(back.isApprox(delta));
}

TEST_CASE("the scale anchor's Jacobian is that of its Plus, in right increments") {
  const FixedDistanceManifold manifold(Vector3(0.5, -0.2, 0.1));
  const SE3 T = se3::exp((Vector6() << 0.1, -0.7, 0.3, 1, 2, 3).finished());
  const PoseBlock x(T);
  Eigen::Matrix<double, 7, 5, Eigen::RowMajor> J;
  REQUIRE(manifold.PlusJacobian(x.values, J.data()));
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  const auto numeric = central_differences<6, 5>([&](const Vector5& delta) -> Vector6 {
    PoseBlock moved;
    manifold.Plus(x.values, delta.data(), moved.values);
    return se3::log(T.inverse() * moved.pose());
  });
  CHECK(relative_error(J.topRows<6>(), numeric) < 1e-6);
  CHECK(J.row(6).isZero());
}
