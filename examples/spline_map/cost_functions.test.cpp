#include "cost_functions.hpp"

#include <evbench/plugin_test.hpp>

#include "testing.hpp"

using namespace spline_map;

namespace {

const evbench::PinholeCamera camera{200.0, 200.0, 120.0, 90.0};

/// The cost function's residuals, and its Jacobian with respect to one parameter block.
struct Evaluated {
  Eigen::VectorXd residuals;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobian;
};

Evaluated evaluate(const ceres::CostFunction& cost, const std::vector<const double*>& blocks, std::size_t block) {
  Evaluated result{Eigen::VectorXd(cost.num_residuals()), {}};
  result.jacobian.resize(cost.num_residuals(), cost.parameter_block_sizes()[block]);
  std::vector<double*> jacobians(blocks.size(), nullptr);
  jacobians[block] = result.jacobian.data();
  CHECK(cost.Evaluate(blocks.data(), result.residuals.data(), jacobians.data()));
  Eigen::VectorXd alone(cost.num_residuals());
  CHECK(cost.Evaluate(blocks.data(), alone.data(), nullptr));
  CHECK((alone - result.residuals).norm() <= 1e-9 * (1.0 + alone.norm()));
  return result;
}

template <std::size_t N>
std::vector<const double*> blocks_of(const std::array<Knot, N>& knots) {
  std::vector<const double*> result;
  for (const Knot& knot : knots) result.push_back(knot.values);
  return result;
}

/// Checks ∂residuals/∂tangent of each knot; `residuals` takes the knots.
template <int M, std::size_t N, class Residuals>
void check_knots(const ceres::CostFunction& cost, const std::array<Knot, N>& knots,
                 const std::vector<const double*>& blocks, Residuals residuals) {
  for (std::size_t j = 0; j < N; ++j) {
    const Evaluated at = evaluate(cost, blocks, j);
    const auto numeric = testing::differences<M, 6>([&](const Vector6& delta) {
      auto moved = knots;
      moved[j] = knots[j].moved(delta);
      return residuals(moved);
    });
    const double scale = std::max(1.0, numeric.cwiseAbs().maxCoeff());
    CHECK((at.jacobian.leftCols(6) - numeric).cwiseAbs().maxCoeff() < 1e-6 * scale);
    CHECK(at.jacobian.col(6).isZero());
  }
}

template <int M, std::size_t N>
void check_knots(const ceres::CostFunction& cost, const std::array<Knot, N>& knots) {
  check_knots<M>(cost, knots, blocks_of(knots), [&](const std::array<Knot, N>& moved) {
    Eigen::Matrix<double, M, 1> result;
    cost.Evaluate(blocks_of(moved).data(), result.data(), nullptr);
    return result;
  });
}

}  // namespace

TEST_CASE("Jacobians of the reprojection cost agree with central differences") {
  std::mt19937_64 generator(3);
  for (int i = 0; i < 100; ++i) {
    const auto knots = testing::random_knots<4>(generator, i);
    const double u = std::uniform_real_distribution(0.0, 1.0)(generator);
    const SplineSegment segment = testing::segment(knots);
    const Vector3 landmark = segment.pose(u) * Vector3(testing::random_vector(generator, 1.0) + Vector3(0, 0, 3));
    const evbench::UndistortedObservation z{0, 0.0, {100.0, 80.0}, 0.7};
    const ReprojectionCost cost(segment, u, z, camera);
    auto blocks = blocks_of(knots);
    blocks.push_back(landmark.data());
    check_knots<2>(cost, knots, blocks, [&](const std::array<Knot, 4>& moved) {
      return Vector2(reprojection_error(testing::segment(moved).pose(u), landmark, z.pixel, camera) / z.noise.sigma());
    });
    const HeldReprojectionCost held(segment.pose(u), z, camera);
    const Evaluated of_held = evaluate(held, {landmark.data()}, 0), of_cost = evaluate(cost, blocks, 4);
    const auto numeric = testing::differences<2, 3>([&](const Vector3& delta) {
      return Vector2(reprojection_error(segment.pose(u), landmark + delta, z.pixel, camera) / z.noise.sigma());
    });
    CHECK((of_held.jacobian - numeric).norm() < 1e-6 * std::max(1.0, numeric.norm()));
    CHECK((of_cost.jacobian - numeric).norm() < 1e-6 * std::max(1.0, numeric.norm()));
    CHECK((of_held.residuals - of_cost.residuals).norm() < 1e-9);
  }
}

TEST_CASE("A landmark behind the camera has a constant error and zero Jacobians") {
  const Vector3 landmark(0.1, 0.2, -1.0);
  const HeldReprojectionCost cost(SE3{}, {0, 0.0, {100.0, 80.0}, 1.0}, camera);
  const Evaluated at = evaluate(cost, {landmark.data()}, 0);
  CHECK(at.residuals == Vector2::Constant(2.0 * camera.fx));
  CHECK(at.jacobian.isZero());
}

TEST_CASE("Jacobians of the penalty on accelerations agree with central differences") {
  std::mt19937_64 generator(4);
  for (int i = 0; i < 100; ++i) check_knots<6>(AccelerationCost(0.5, 2.0, 0.3), testing::random_knots<3>(generator, i));
}

TEST_CASE("A motion of constant velocity has zero cost") {
  std::array<Knot, 3> knots;
  const Vector6 step = (Vector6() << 0.1, -0.2, 0.3, 1.0, 2.0, 3.0).finished();
  for (std::size_t k = 1; k < 3; ++k) knots[k] = knots[k - 1].moved(step);
  Vector6 residuals;
  AccelerationCost(1.0, 1.0, 0.1).Evaluate(blocks_of(knots).data(), residuals.data(), nullptr);
  CHECK(residuals.norm() < 1e-9);
}

TEST_CASE("Jacobians of the anchors agree with central differences") {
  std::mt19937_64 generator(5);
  for (int i = 0; i < 100; ++i) {
    const auto knots = testing::random_knots<4>(generator, i);
    SE3 near = testing::segment(knots).pose(0.0);
    near.p += testing::random_vector(generator, 0.1);
    near.q = near.q * evbench::so3::exp(testing::random_vector(generator, 0.1));
    check_knots<6>(PoseAnchorCost(near, 0.1), knots);
    check_knots<1>(BaselineCost({-0.5, -0.5, 0.3, 0.7}, 0.4, 0.1), knots);
  }
}

TEST_CASE("The manifold's Minus undoes its Plus") {
  std::mt19937_64 generator(6);
  const KnotManifold manifold;
  const Knot knot = testing::random_knots<1>(generator, 3)[0];
  const Vector6 delta = (Vector6() << 0.2, 0.1, -0.3, 0.5, -0.4, 0.1).finished();
  Knot moved;
  Vector6 back;
  REQUIRE(manifold.Plus(knot.values, delta.data(), moved.values));
  REQUIRE(manifold.Minus(moved.values, knot.values, back.data()));
  CHECK(back.isApprox(delta));
}
