#include "frontends/haste/tracking/change.hpp"

#include <functional>

#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::haste;

namespace {

Change with_scores(const std::function<double(double x, double y)>& score) {
  Change change;
  change.before.position = {50, 40};
  change.after.position = {51, 40};
  for (std::size_t h = 0; h < kHypotheses; ++h) change.scores.of[h] = score(kSteps[h].x, kSteps[h].y);
  return change;
}

}  // namespace

TEST_CASE("The refined position is the maximum of a paraboloid through the scores") {
  const Change change = with_scores([](double x, double y) {
    const double u = x - 0.4, v = y + 0.2;
    return 3.0 - 2.0 * u * u - u * v - v * v;
  });
  CHECK(refined_position(change).isApprox(Vector2(50.4, 39.8)));
  CHECK(midpoint(change) == Vector2(50.5, 40));
}

TEST_CASE("The refined position is no more than a pixel away, and the midpoint where there is no maximum") {
  const Change far = with_scores([](double x, double y) { return 8.0 * x - x * x - y * y; });
  CHECK(refined_position(far).isApprox(Vector2(51, 40)));
  const Change valley = with_scores([](double x, double y) { return x * x + y * y; });
  CHECK(refined_position(valley) == Vector2(50.5, 40));
  const Change flat = with_scores([](double, double) { return 1.0; });
  CHECK(refined_position(flat) == Vector2(50.5, 40));
}

TEST_CASE("The weakest curvature is the scores' fall in the direction of the smallest fall") {
  const Scores peak =
      with_scores([](double x, double y) { return 10.0 - 2.0 * x * x - 2.0 * x * y - 2.0 * y * y; }).scores;
  CHECK(peak.weakest_curvature() == Approx(0.2));  // 2 lower at (1, -1), of 10
  const Scores edge = with_scores([](double x, double y) { return -10.0 - (x + y) * (x + y); }).scores;
  CHECK(edge.weakest_curvature() == Approx(0.0).margin(1e-12));
  const Scores saddle = with_scores([](double x, double y) { return 4.0 - x * x + y * y; }).scores;
  CHECK(saddle.weakest_curvature() == Approx(-0.4));
  CHECK(Scores().weakest_curvature() == 0.0);
}

TEST_CASE("The flatness is the uncertainty of the scores' maximum, the inverse of their curvature") {
  const Scores peak = with_scores([](double x, double y) { return 10.0 - x * x - 2.5 * y * y; }).scores;
  CHECK(peak.flatness()->trace() == Approx(5.0 + 2.0));  // their second derivatives are 2 and 5, of 10
  const Scores turned =
      with_scores([](double x, double y) { return 10.0 - 1.75 * (x * x + y * y) + 1.5 * x * y; }).scores;
  CHECK(turned.flatness()->trace() == Approx(peak.flatness()->trace()));  // by 45°
  const Scores saddle = with_scores([](double x, double y) { return 4.0 - x * x + y * y; }).scores;
  CHECK_FALSE(saddle.flatness());
  CHECK_FALSE(Scores().flatness());
}

TEST_CASE("Scores have a best, a worst and a spread, of either sign") {
  Scores scores;
  CHECK(scores.spread() == 0.0);
  scores.of.fill(2.0);
  scores.of[3] = 4.0;
  scores.of[5] = 1.0;
  CHECK(scores.best() == 4.0);
  CHECK(scores.worst() == 1.0);
  CHECK(scores.spread() == Approx(0.75));
  for (double& score : scores.of) score = -score;
  CHECK(scores.spread() == Approx(0.75));
}
