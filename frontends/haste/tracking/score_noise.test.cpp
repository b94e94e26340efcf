#include "frontends/haste/tracking/score_noise.hpp"

#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::haste;

namespace {

/// Scores that fall by so much a pixel from the best one, along x and along y.
Scores peak(double x, double y) {
  Scores scores;
  for (std::size_t h = 0; h < kHypotheses; ++h) {
    scores.of[h] = 10.0 - x * kSteps[h].x * kSteps[h].x - y * kSteps[h].y * kSteps[h].y;
  }
  return scores;
}

double along_x(const PixelNoise& noise) { return std::sqrt(noise.xx()); }
double along_y(const PixelNoise& noise) { return std::sqrt(noise.yy()); }

}  // namespace

TEST_CASE(
    "An observation's noise is the usual one where scores fall as they usually do, and larger where they fall less") {
  ScoreNoise noise(0.5);
  for (int i = 0; i < 100; ++i) CHECK(noise.next(peak(1.0, 1.0)).sigma() == Approx(0.5).epsilon(0.02));
  CHECK(noise.next(peak(0.5, 0.5)).sigma() == Approx(1.0).epsilon(0.02));
  CHECK(noise.next(peak(1.5, 1.5)).sigma() == Approx(0.333).epsilon(0.02));
}

TEST_CASE("Along an edge the noise is large, across it small") {
  ScoreNoise noise(0.5);
  noise.next(peak(1.0, 1.0));
  const PixelNoise edge = noise.next(peak(1.0, 0.4));
  CHECK(along_x(edge) == Approx(0.5).epsilon(0.02));
  CHECK(along_y(edge) == Approx(1.25).epsilon(0.02));
  CHECK(edge.xy() == Approx(0.0).margin(1e-12));
}

TEST_CASE("An observation's noise is bounded, and the largest where scores have no maximum") {
  ScoreNoise noise(0.5);
  noise.next(peak(1.0, 1.0));
  CHECK(noise.next(peak(0.01, 0.01)).sigma() == Approx(1.5));
  CHECK(along_y(noise.next(peak(1.0, 0.01))) == Approx(1.5));
  CHECK(noise.next(peak(0.0, 0.0)) == PixelNoise(1.5));
  CHECK(noise.next(peak(-1.0, 1.0)) == PixelNoise(1.5));
  CHECK(noise.next(Scores()) == PixelNoise(1.5));
  CHECK(noise.next(peak(9.0, 9.0)).sigma() == Approx(0.25));
}

TEST_CASE("The usual flatness follows the tracks") {
  ScoreNoise noise(0.5);
  for (int i = 0; i < 100; ++i) noise.next(peak(1.0, 1.0));
  for (int i = 0; i < 200; ++i) noise.next(peak(0.5, 0.5));
  CHECK(noise.next(peak(0.5, 0.5)).sigma() == Approx(0.5).epsilon(0.02));
}
