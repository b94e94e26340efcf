#include "spline_segment.hpp"

#include <evbench/plugin.hpp>
#include <evbench/plugin_test.hpp>
#include <random>

#include "testing.hpp"

using namespace spline_map;

TEST_CASE("The weights of the basis sum to one and their derivatives to zero") {
  for (const double u : {0.0, 0.1, 0.5, 0.9, 1.0}) {
    double sum = 0.0, slope = 0.0;
    for (std::size_t j = 0; j < 4; ++j) {
      CHECK(BasisWeights(u).plain[j] >= 0.0);
      sum += BasisWeights(u).plain[j];
      slope += BasisWeights::derivative(u).plain[j];
    }
    CHECK(sum == Approx(1.0));
    CHECK(slope == Approx(0.0).margin(1e-15));
  }
}

TEST_CASE("Jacobians of a segment's pose agree with central differences") {
  std::mt19937_64 generator(1);
  for (int i = 0; i < 300; ++i) {
    const auto knots = testing::random_knots<4>(generator, i);
    const double u = std::uniform_real_distribution(0.0, 1.0)(generator);
    SplineSegment::Jacobians J;
    const SE3 T = testing::segment(knots).pose(u, J);
    CHECK(T.p == testing::segment(knots).pose(u).p);
    for (std::size_t j = 0; j < 4; ++j) {
      const auto numeric = testing::differences<6, 6>([&](const Vector6& delta) {
        auto moved = knots;
        moved[j] = knots[j].moved(delta);
        const SE3 other = testing::segment(moved).pose(u);
        return (Vector6() << evbench::so3::log(T.q.conjugate() * other.q), other.p - T.p).finished();
      });
      evbench::Matrix6 analytic = evbench::Matrix6::Zero();
      analytic.topLeftCorner<3, 3>() = J.rotation[j];
      analytic.bottomRightCorner<3, 3>() = J.position[j] * Matrix3::Identity();
      CHECK((analytic - numeric).cwiseAbs().maxCoeff() < 1e-7);
    }
  }
}

TEST_CASE("A segment's velocity is the derivative of its pose, and neighbouring segments join smoothly") {
  std::mt19937_64 generator(2);
  for (int i = 0; i < 100; ++i) {
    const auto knots = testing::random_knots<5>(generator, i);
    const SplineSegment left(knots[0], knots[1], knots[2], knots[3]), right(knots[1], knots[2], knots[3], knots[4]);
    CHECK((left.pose(1.0).p - right.pose(0.0).p).norm() < 1e-12);
    CHECK(left.pose(1.0).q.angularDistance(right.pose(0.0).q) < 1e-7);
    CHECK((left.velocity(1.0) - right.velocity(0.0)).norm() < 1e-9);
    const double u = 0.1 + 0.008 * i;
    const SE3 T = left.pose(u);
    const auto numeric = testing::differences<6, 1>([&](const Eigen::Matrix<double, 1, 1>& du) {
      const SE3 other = left.pose(u + du(0));
      return (Vector6() << evbench::so3::log(T.q.conjugate() * other.q), T.q.conjugate() * (other.p - T.p)).finished();
    });
    CHECK((left.velocity(u) - numeric).norm() < 1e-7);
  }
}
