#include "frontends/haste/guidance.hpp"

#include <cmath>
#include <vector>

#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::haste;

namespace {

Camera pinhole() {
  Camera camera;
  camera.width = 240;
  camera.height = 180;
  camera.pinhole = {200.0, 200.0, 119.5, 89.5};
  return camera;
}

SE3 turned(double about_z, const Vector3& p = Vector3::Zero()) {
  Vector6 twist = Vector6::Zero();
  twist.z() = about_z;
  SE3 T = se3::exp(twist);
  T.p = p;
  return T;
}

/// Landmarks at different depths, tracks 0 to count − 1, and a camera at the origin at t = 1 s.
Feedback feedback(int count, const Vector6& velocity = Vector6::Zero()) {
  Feedback result;
  result.t = 1.0;
  result.state = TrackingState::tracking;
  result.newest = ControlState{1.0, {}, velocity};
  for (int i = 0; i < count; ++i) {
    const Vector3 point(-0.8 + 0.17 * i, 0.5 * std::cos(2.0 * i), 2.0 + 0.3 * (i % 3));
    result.expected.push_back({i, point, {}, Matrix2::Identity()});
  }
  return result;
}

/// The landmarks as seen from a pose at t [s].
std::vector<Guidance::Sighting> sightings(const Camera& camera, const Feedback& known, const SE3& T, double t) {
  std::vector<Guidance::Sighting> result;
  for (const ExpectedFeature& feature : known.expected) {
    result.push_back({feature.track, t, camera.project(T.inverse() * feature.position)});
  }
  return result;
}

}  // namespace

TEST_CASE("The back-end's state is extrapolated with constant velocity") {
  const Camera camera = pinhole();
  Guidance guidance(camera, true);
  CHECK_FALSE(guidance.available());
  CHECK_FALSE(guidance.predict(0, 1.0));

  Vector6 velocity;
  velocity << 0.1, -0.2, 0.5, 1.0, 0.4, -0.3;
  const Feedback known = feedback(3, velocity);
  guidance.receive(known);
  REQUIRE(guidance.available());
  const SE3 later = se3::exp(0.1 * velocity);
  CHECK((guidance.pose(1.1).p - later.p).norm() < 1e-12);
  const auto predicted = guidance.predict(2, 1.1);
  REQUIRE(predicted);
  CHECK((predicted->pixel - camera.project(later.inverse() * known.expected[2].position)).norm() < 1e-9);
  CHECK(predicted->covariance == known.expected[2].covariance);
  CHECK_FALSE(guidance.predict(3, 1.1));  // not expected in view
}

TEST_CASE("A back-end that does not track predicts nothing, but a degraded one does where the option is set") {
  const Camera camera = pinhole();
  for (const bool degraded : {false, true}) {
    Guidance guidance(camera, degraded);
    for (const TrackingState state : {TrackingState::no_map, TrackingState::degraded, TrackingState::lost}) {
      guidance.receive(feedback(3));
      REQUIRE(guidance.predict(0, 1.0));
      CHECK(guidance.reliable());
      Feedback known = feedback(3);
      known.state = state;
      guidance.receive(known);
      const bool predicts = degraded && state == TrackingState::degraded;
      CHECK(guidance.available() == predicts);
      CHECK(guidance.predict(0, 1.0).has_value() == predicts);
      CHECK(guidance.position(0).has_value() == predicts);
      CHECK_FALSE(guidance.reliable());
    }
  }
}

TEST_CASE("A landmark behind the camera is not predicted") {
  const Camera camera = pinhole();
  Guidance guidance(camera, true);
  Feedback known = feedback(1);
  known.expected.front().position = {0.1, 0.0, -2.0};
  guidance.receive(known);
  CHECK_FALSE(guidance.predict(0, 1.0));
  CHECK(guidance.position(0));
}

TEST_CASE("The predicted pose is fitted to the observed landmarks, with or without an outlier") {
  const Camera camera = pinhole();
  const Feedback known = feedback(10);
  const SE3 truth = turned(0.03, {0.04, -0.02, 0.03});
  for (const bool stray : {false, true}) {
    Guidance guidance(camera, true);
    guidance.receive(known);
    std::vector<Guidance::Sighting> seen = sightings(camera, known, truth, 1.05);
    if (stray) seen[4].pixel += Vector2(25.0, -10.0);
    guidance.correct(seen);
    const SE3 left = truth.inverse() * guidance.pose(1.05);
    CHECK(left.p.norm() < 0.01);
    CHECK(se3::log(left).head<3>().norm() < 0.005);
    // New feedback resets the correction.
    guidance.receive(known);
    CHECK(guidance.pose(1.05).p.norm() == 0.0);
  }
}

TEST_CASE("Seven sightings are too few to correct the predicted motion by, eight are enough") {
  const Camera camera = pinhole();
  const Feedback known = feedback(8);
  const SE3 truth = turned(0.0, {0.05, 0.0, 0.0});
  std::vector<Guidance::Sighting> seen = sightings(camera, known, truth, 1.0);
  Guidance guidance(camera, true);
  guidance.receive(known);
  guidance.correct(std::span(seen).first(7));
  CHECK(guidance.pose(1.0).p.norm() == 0.0);
  guidance.correct(seen);
  CHECK((guidance.pose(1.0).p - truth.p).norm() < 0.005);
  // Sightings of landmarks that are not expected do not count.
  for (Guidance::Sighting& sighting : seen) sighting.track += 100;
  guidance.correct(seen);
  CHECK(guidance.pose(1.0).p.norm() == 0.0);
}

TEST_CASE("The appearance of a point turns against the camera, and grows as it comes nearer") {
  const Vector3 point(0.3, -0.2, 2.0);
  const AppearanceChange same = appearance_change({}, {}, point);
  CHECK(same.angle == Approx(0.0).margin(1e-9));
  CHECK(same.scale == Approx(1.0));
  const AppearanceChange roll = appearance_change({}, turned(0.4), point);
  CHECK(roll.angle == Approx(-0.4).margin(1e-6));
  CHECK(roll.scale == Approx(1.0));
  const AppearanceChange near = appearance_change({}, turned(0.0, {0.0, 0.0, 1.0}), point);
  CHECK(near.angle == Approx(0.0).margin(1e-6));
  CHECK(near.scale == Approx(2.0).epsilon(1e-3));
  // Behind the camera there is no appearance.
  const AppearanceChange behind = appearance_change({}, turned(0.0, {0.0, 0.0, 3.0}), point);
  CHECK(behind.scale == 1.0);
}
