#include "frontends/haste/tracking/score_sigma.hpp"

#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::haste;

namespace {

/// Scores that fall by so much a pixel from the best one.
Scores peak(double fall) {
  Scores scores;
  for (std::size_t h = 0; h < kHypotheses; ++h) {
    scores.of[h] = 10.0 - fall * (kSteps[h].x * kSteps[h].x + kSteps[h].y * kSteps[h].y);
  }
  return scores;
}

}  // namespace

TEST_CASE(
    "An observation's sigma is the usual one where scores fall as they usually do, and larger where they fall less") {
  ScoreSigma sigma(0.5);
  for (int i = 0; i < 100; ++i) CHECK(sigma.next(peak(1.0)) == Approx(0.5).epsilon(0.02));
  CHECK(sigma.next(peak(0.5)) == Approx(1.0).epsilon(0.02));
  CHECK(sigma.next(peak(1.5)) == Approx(0.333).epsilon(0.02));
}

TEST_CASE("An observation's sigma is bounded, and the largest where scores have no maximum") {
  ScoreSigma sigma(0.5);
  sigma.next(peak(1.0));
  CHECK(sigma.next(peak(0.01)) == 1.5);
  CHECK(sigma.next(peak(0.0)) == 1.5);
  CHECK(sigma.next(peak(-1.0)) == 1.5);
  CHECK(sigma.next(Scores()) == 1.5);
  CHECK(sigma.next(peak(9.0)) == 0.25);
}

TEST_CASE("The usual flatness follows the tracks") {
  ScoreSigma sigma(0.5);
  for (int i = 0; i < 100; ++i) sigma.next(peak(1.0));
  for (int i = 0; i < 200; ++i) sigma.next(peak(0.5));
  CHECK(sigma.next(peak(0.5)) == Approx(0.5).epsilon(0.02));
}
