#include "frontends/str/registration/neighbour_grid.hpp"

#include <limits>

#include "core/simulation/random.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::str;

namespace {

struct Points {
  std::vector<float> x, y, t;
  std::vector<std::uint8_t> kind;

  void add(double px, double py, std::uint8_t k = 0, double time = 0.0) {
    x.push_back(static_cast<float>(px));
    y.push_back(static_cast<float>(py));
    t.push_back(static_cast<float>(time));
    kind.push_back(k);
  }
  void build(NeighbourGrid& grid, float cell) const { grid.build(x, y, t, kind, cell); }
};

}  // namespace

TEST_CASE("The nearest point of a kind is that of an exhaustive search, at any position and cell size") {
  const float cell = GENERATE(0.3F, 1.0F, 7.0F);
  Random random(1);
  NeighbourGrid grid;
  for (int build = 0; build < 3; ++build) {  // earlier points are forgotten
    Points points;
    for (int i = 0; i < 300; ++i) {
      points.add(random.uniform(-20.0, 30.0), random.uniform(-5.0, 25.0), static_cast<std::uint8_t>(i % 3 == 0));
    }
    points.build(grid, cell);
    for (int i = 0; i < 500; ++i) {
      const auto x = static_cast<float>(random.uniform(-25.0, 35.0)),
                 y = static_cast<float>(random.uniform(-9.0, 29.0));
      const auto kind = static_cast<std::uint8_t>(i % 2);
      const auto gate = static_cast<float>(random.uniform(0.1, 6.0));
      float nearest = gate * gate;
      std::optional<std::size_t> expected;
      for (std::size_t k = 0; k < points.x.size(); ++k) {
        const float dx = points.x[k] - x, dy = points.y[k] - y;
        if (points.kind[k] != kind || dx * dx + dy * dy >= nearest) continue;
        nearest = dx * dx + dy * dy;
        expected = k;
      }
      const auto found = grid.nearest(x, y, kind, gate);
      REQUIRE(found.has_value() == expected.has_value());
      if (found) CHECK(found->point == *expected);
    }
  }
}

TEST_CASE("A distance counts across an edge and not along it, and little where points lie everywhere") {
  NeighbourGrid grid;
  Points edge, everywhere;
  for (int i = 0; i < 200; ++i) edge.add(0.1 * i, 0.05 * i, 1, 0.01 * i);
  edge.build(grid, 2.0F);
  const auto on_edge = grid.nearest(10.0F, 5.0F, 1, 1.0F);
  REQUIRE(on_edge);
  const NeighbourGrid::Surroundings& s = grid.surroundings(on_edge->cell, 0.4F);
  const Eigen::Vector2f along = Eigen::Vector2f(2.0F, 1.0F).normalized(), across(-along.y(), along.x());
  CHECK(across.dot(s.weight * across) == Approx(1.0).margin(0.01));
  CHECK(along.dot(s.weight * along) < 0.1F);
  CHECK(std::abs(across.dot(s.mean)) < 0.01F);
  CHECK(s.time == Approx(0.1 * s.mean.x()).margin(0.01));

  Random random(1);
  for (int i = 0; i < 5000; ++i) everywhere.add(random.uniform(0.0, 20.0), random.uniform(0.0, 20.0));
  everywhere.build(grid, 2.0F);
  const auto amid = grid.nearest(10.0F, 10.0F, 0, 1.0F);
  REQUIRE(amid);
  CHECK(grid.surroundings(amid->cell, 0.4F).weight.trace() < 0.2F);
}

TEST_CASE("An empty grid finds nothing, and points that are not finite are left out") {
  NeighbourGrid grid;
  Points none, odd;
  none.build(grid, 1.0F);
  CHECK_FALSE(grid.nearest(0.0F, 0.0F, 0, 1e3F));
  odd.add(std::numeric_limits<double>::quiet_NaN(), 1.0);
  odd.add(1.0, std::numeric_limits<double>::infinity());
  odd.add(1.0, 1.0);
  odd.build(grid, 1.0F);
  REQUIRE(grid.nearest(1.2F, 1.0F, 0, 1.0F));
  CHECK(grid.nearest(1.2F, 1.0F, 0, 1.0F)->point == 2);
  CHECK_FALSE(grid.nearest(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0, 1.0F));
}
