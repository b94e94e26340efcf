#include "spline.hpp"

#include <evbench/plugin_test.hpp>

#include "testing.hpp"

using namespace spline_map;

namespace {

/// Rotation about a fixed axis and straight translation: a spline with even steps represents it exactly.
Spline even_motion(const Vector6& step, int knots) {
  Spline spline(2.0, 0.1, SE3{});
  spline.knots().resize(1);
  while (static_cast<int>(spline.knots().size()) < knots) spline.knots().push_back(spline.knots().back().moved(step));
  return spline;
}

}  // namespace

TEST_CASE("A spline with even steps has constant velocity") {
  const Vector6 step = (Vector6() << 0.0, 0.0, 0.05, 0.1, 0.2, 0.0).finished();
  const Spline spline = even_motion(step, 10);
  CHECK(spline.start() == 2.0);
  CHECK(spline.end() == Approx(2.7));
  for (const double t : {2.0, 2.13, 2.5, 2.7}) {
    const double knots_from_start = (t - 2.0) / 0.1 + 1.0;
    const auto state = spline.state(t);
    CHECK((state.T.p - knots_from_start * step.tail<3>()).norm() < 1e-12);
    CHECK((evbench::so3::log(state.T.q) - knots_from_start * step.head<3>()).norm() < 1e-12);
    CHECK((state.velocity.head<3>() - 10.0 * step.head<3>()).norm() < 1e-9);
    CHECK((state.T.q * state.velocity.tail<3>() - 10.0 * step.tail<3>()).norm() < 1e-9);
  }
}

TEST_CASE("Extending a spline continues its last step without changing the covered part, and it can be cut again") {
  std::mt19937_64 generator(8);
  Spline spline(0.0, 0.1, SE3{});
  for (const Knot& knot : testing::random_knots<6>(generator, 3)) spline.knots().push_back(knot);
  const double end = spline.end();
  const SE3 before = spline.pose(end - 0.05);
  const std::size_t knots = spline.knots().size();
  spline.extend_to(end + 0.35);
  CHECK(spline.end() >= end + 0.35);
  CHECK(spline.knots().size() == knots + 4);
  CHECK(spline.pose(end - 0.05).p == before.p);
  const Vector3 step = spline.knots()[knots - 1].position() - spline.knots()[knots - 2].position();
  CHECK((spline.knots().back().position() - spline.knots()[knots - 1].position() - 4.0 * step).norm() < 1e-12);
  spline.cut(end - 1e-9);
  CHECK(spline.knots().size() == knots);
  spline.cut(-1.0);
  CHECK(spline.segments() == 1);
}
