#include "core/structure/depth_reversal.hpp"

#include "core/testing/catch2.hpp"

namespace evbench {

TEST_CASE("Depth reversal leaves the image of a short motion nearly unchanged") {
  InitialGuess guess;
  guess.T1 = se3::exp((Vector6() << 0.01, -0.02, 0.005, 0.0, 0.0, 0.0).finished());
  guess.T1.p = {0.06, -0.04, 0.01};
  for (const double z : {0.85, 1.0, 1.15}) guess.landmarks.push_back({0, Vector3(0.1, -0.1, 1.0) * z});
  const InitialGuess reversed = reverse_depth(guess);
  const PinholeCamera camera{200.0, 200.0, 120.0, 90.0};
  for (std::size_t i = 0; i < guess.landmarks.size(); ++i) {
    const Vector3 now = guess.landmarks[i].position, other = reversed.landmarks[i].position;
    CHECK((camera.project(now) - camera.project(other)).norm() < 1e-9);
    const Vector2 moved = camera.project(guess.T1.inverse() * now) - camera.project(now);
    const Vector2 moved_other = camera.project(reversed.T1.inverse() * other) - camera.project(other);
    CHECK((moved - moved_other).norm() < 0.1 * moved.norm());
  }
  CHECK(reversed.landmarks[0].position.z() > reversed.landmarks[2].position.z());
  CHECK_FALSE(same_motion(guess.T1, reversed.T1));
}

TEST_CASE("Reversing twice gives the guess back") {
  InitialGuess guess;
  guess.T1.p = {0.06, -0.04, 0.01};
  for (const double z : {0.9, 1.0, 1.1}) guess.landmarks.push_back({0, Vector3(0.1, -0.1, 1.0) * z});
  const InitialGuess twice = reverse_depth(reverse_depth(guess));
  CHECK(same_motion(twice.T1, guess.T1));
  CHECK((twice.landmarks[0].position - guess.landmarks[0].position).norm() < 1e-12);
  CHECK(reverse_depth(guess).landmarks[1].position.z() == Approx(1.0));
}

}  // namespace evbench
