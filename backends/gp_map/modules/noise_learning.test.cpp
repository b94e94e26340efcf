#include "backends/gp_map/modules/noise_learning.hpp"

#include <cmath>
#include <functional>

#include "core/simulation/random.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {
namespace {

constexpr double kRate = 100.0, kInterval = 0.05, kEnd = 10.0;  // [Hz], [s]
constexpr int kTracks = 20;

/// A camera that sees points all over the image with an error of error(track, t) [px], and that the graph takes to be
/// at rest.
FactorGraph seen(
    const std::function<Vector2(int track, double t)>& error,
    const std::function<SE3(double t)>& motion = [](double) { return SE3{}; }) {
  FactorGraph graph;
  graph.camera = {200.0, 200.0, 119.5, 89.5};
  graph.loss = RobustLoss(RobustLoss::Kind::cauchy, 2.0);
  for (double t = 0.0; t < kEnd; t += kInterval) graph.add_state({t, SE3{}, Vector6::Zero()});
  for (int j = 0; j < kTracks; ++j) graph.add_landmark({0.4 * (j % 5 - 2), 0.3 * (j / 5 - 1.5), 1.0 + 0.1 * (j % 3)});
  for (double t = 0.5 / kRate; t < kEnd; t += 1.0 / kRate) {
    for (int j = 0; j < kTracks; ++j) {
      const Vector3 point = motion(t).inverse() * graph.landmarks[index(j)].position;
      const Vector2 pixel = graph.camera.project(point) + error(j, t);
      graph.add_observation(j, {t, pixel, 1.0});
    }
  }
  return graph;
}

Vector2 white(Random& random, double sigma) { return sigma * random.normal2(); }

}  // namespace

TEST_CASE("White noise is estimated correctly although a tenth of the tracks are outliers") {
  for (const double sigma : {0.1, 1.0, 5.0}) {
    Random random(1);
    const NoiseLearner noise = learn_noise(seen([&](int track, double) {
      const double off = track % 10 == 0 ? 20.0 * sigma : 0.0;
      return Vector2(white(random, sigma) + off * Vector2::Ones());
    }));
    CAPTURE(sigma);
    CHECK(noise.scale() == Approx(sigma).epsilon(0.15));
    CHECK(noise.share() > 0.7);
  }
}

TEST_CASE("Drifting errors count as much as their means over a fifth of a second") {
  constexpr double kCorrelationTime = 1.0, kSigma = 0.5;  // [s], [px]
  Random random(2);
  std::vector<Vector2> drift(kTracks, Vector2::Zero());
  const double keep = std::exp(-1.0 / (kRate * kCorrelationTime));
  const NoiseLearner noise = learn_noise(seen([&](int track, double) {
    drift[index(track)] = keep * drift[index(track)] + white(random, kSigma * std::sqrt(1.0 - keep * keep));
    return drift[index(track)];
  }));
  CHECK(noise.scale() == Approx(kSigma).epsilon(0.2));
  CHECK(noise.share() == Approx(1.0 / (0.2 * kRate)).epsilon(0.4));  // a block's observations count as one
}

TEST_CASE("Errors that all tracks have in common are attributed to the motion, not to noise") {
  Random random(3);
  const FactorGraph shaken = seen([&](int, double) { return white(random, 0.3); },
                                  [](double t) {
                                    Vector6 step;
                                    step << 0.02, -0.01, 0.03, 0.02, 0.03, -0.01;
                                    return se3::exp(std::sin(5.0 * t) * step);
                                  });
  const NoiseLearner noise = learn_noise(shaken);
  CHECK(noise.scale() == Approx(0.3).epsilon(0.15));
  CHECK(noise.share() > 0.7);
}

TEST_CASE("While running, the noise follows recent data") {
  Random random(4);
  const FactorGraph all = seen([&](int, double t) { return white(random, t < 0.5 * kEnd ? 0.2 : 1.0); });
  NoiseLearner noise;
  CHECK(noise.scale() == 1.0);
  CHECK(noise.share() == 1.0);
  FactorGraph until = all;
  while (until.states.back().t > 0.5 * kEnd) until.remove_newest_state();
  noise.follow(until, 1.0);
  CHECK(noise.scale() == Approx(0.2).epsilon(0.15));
  noise.follow(all, 1.0);
  CHECK(noise.scale() == Approx(1.0).epsilon(0.15));
}

}  // namespace evbench::gp_map
