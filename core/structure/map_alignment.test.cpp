#include "core/structure/map_alignment.hpp"

#include <vector>

#include "core/geometry/so3.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/point_scene.hpp"

namespace evbench {
namespace {

using testing::PointScene;

/// Transform from the earlier map's world to the later one's.
const Similarity kTruth = {2.5, {so3::exp({0.4, -0.2, 0.6}), {3.0, -1.0, 0.5}}};

/// A camera that moves to the right, and two maps of its scene; the later one has errors along the rays.
struct Maps {
  std::vector<SE3> views;
  std::vector<Landmark> now, before;

  Maps(PointScene scene, double baseline, double depth_error, int count = 40, std::uint64_t seed = 1) {
    Random random(seed);
    for (int i = 0; i < 5; ++i) views.push_back({Eigen::Quaterniond::Identity(), {0.25 * baseline * i, 0.0, 0.0}});
    TrackId track = 0;
    for (const Vector3& point : testing::scene_points(scene, count, random, 1.6)) {
      const Vector3 middle(0.5 * baseline, 0.0, 0.0);
      now.push_back({track, middle + (1.0 + depth_error * random.normal()) * (point - middle)});
      before.push_back({track++, kTruth.inverse() * point});
    }
  }

  std::optional<MapAlignment> align() const { return align_maps(now, views, before, testing::davis()); }

  /// Displacement of a point in front of the camera.
  double error(const MapAlignment& found) const {
    const Vector3 point(0.1, 0.2, 2.0);
    return (found.transform * (kTruth.inverse() * point) - point).norm();
  }
};

}  // namespace

TEST_CASE("A similarity and its inverse transform points and poses there and back") {
  const Vector3 point(0.3, -2.0, 1.0);
  const SE3 pose{so3::exp({0.1, 0.2, -0.3}), {1.0, 2.0, 3.0}};
  CHECK((kTruth.inverse() * (kTruth * point) - point).norm() < 1e-12);
  CHECK(((kTruth.inverse() * kTruth) * point - point).norm() < 1e-12);
  CHECK(((kTruth * pose) * (2.5 * point) - kTruth * (pose * point)).norm() < 1e-12);
}

TEST_CASE("Two exact maps of the same landmarks are aligned exactly") {
  for (const PointScene scene : {PointScene::volume, PointScene::plane}) {
    const Maps maps(scene, 0.5, 0.0);
    const auto found = maps.align();
    REQUIRE(found);
    CHECK(found->landmarks == 40);
    CHECK(found->transform.scale == Approx(kTruth.scale).epsilon(1e-6));
    CHECK(maps.error(*found) < 1e-5);
  }
}

TEST_CASE("Alignment is robust against uncertain distances from a short baseline and wrong landmarks") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Maps maps(PointScene::volume, 0.3, 0.02, 60, seed);
    Random random(seed);
    for (int i = 0; i < 30; ++i) {  // half of them
      maps.before[static_cast<std::size_t>(2 * i)].position += random.normal3();
    }
    const auto found = maps.align();
    REQUIRE(found);
    CHECK(found->landmarks >= 24);
    CHECK(maps.error(*found) < 0.03);
  }
}

TEST_CASE("Maps with nothing or too little in common are not aligned") {
  Maps unrelated(PointScene::volume, 0.5, 0.0, 60);
  Random random(7);
  for (Landmark& landmark : unrelated.before) {
    landmark.position = random.uniform3({-2.0, -2.0, 1.0}, {2.0, 2.0, 3.0});
  }
  CHECK_FALSE(unrelated.align());

  Maps few(PointScene::volume, 0.5, 0.0);
  few.before.resize(7);
  CHECK_FALSE(few.align());
  CHECK_FALSE(align_maps({}, few.views, few.before, testing::davis()));
  CHECK_FALSE(align_maps(few.now, {}, few.before, testing::davis()));
}

TEST_CASE("A single view leaves the scale unknown and gives no alignment") {
  CHECK_FALSE(Maps(PointScene::volume, 0.0, 0.0).align());
}

}  // namespace evbench
