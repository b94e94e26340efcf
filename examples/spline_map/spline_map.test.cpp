#include "spline_map.hpp"

#include <cmath>
#include <evbench/plugin.hpp>
#include <evbench/plugin_test.hpp>

#include "testing.hpp"

using namespace spline_map;
using evbench::RunState;
using evbench::UndistortedObservation;

namespace {

const evbench::PinholeCamera camera{200.0, 200.0, 120.0, 90.0};

SE3 circling(double t) {
  const Vector3 p(0.3 * std::cos(2.0 * t) - 0.3, 0.3 * std::sin(2.0 * t), 0.1 * std::sin(t));
  return {evbench::so3::exp({0.1 * std::sin(t), -0.15 * p.x(), 0.2 * t}), p};
}
SE3 resting(double) { return {}; }

/// 50 points, each observed at about 70 Hz at individual times, 0.5 px noise.
std::vector<UndistortedObservation> observe(SE3 (*motion)(double), double duration) {
  std::mt19937_64 generator(9);
  std::normal_distribution<double> noise(0.0, 0.5);
  std::uniform_real_distribution<double> gap(0.007, 0.021);
  std::vector<UndistortedObservation> result;
  for (evbench::TrackId id = 0; id < 50; ++id) {
    const Vector3 point = testing::random_vector(generator, 0.8) + Vector3(0.0, 0.0, 2.5);
    for (double t = gap(generator); t < duration; t += gap(generator)) {
      const double x = noise(generator), y = noise(generator);
      result.push_back({id, t, camera.project(motion(t).inverse() * point) + Vector2(x, y), 0.5});
    }
  }
  std::ranges::stable_sort(result, {}, &UndistortedObservation::t);
  return result;
}

struct Run {
  std::unique_ptr<SplineMap> backend;
  std::vector<evbench::StampedPose> causal;
};

/// Feeds the observations in exchanges of `chunk` seconds until `end`.
Run run(const std::vector<UndistortedObservation>& observations, double end, double chunk = 0.01) {
  Run result;
  evbench::BackEndContext context;
  context.camera = camera;
  auto causal = std::make_shared<std::vector<evbench::StampedPose>>();
  context.publish = [causal](const evbench::StampedPose& pose) { causal->push_back(pose); };
  result.backend = std::make_unique<SplineMap>(Options{}, context);
  auto next = observations.begin();
  for (double until = chunk; until < end + 0.5 * chunk; until += chunk) {
    evbench::UndistortedBatch batch;
    batch.until = until;
    for (; next != observations.end() && next->t <= until; ++next) batch.observations.push_back(*next);
    result.backend->advance(batch);
    for (const auto& feature : result.backend->feedback({true, false, true}).expected) {
      REQUIRE(feature.pixel.allFinite());
      REQUIRE(feature.covariance.allFinite());
    }
  }
  result.backend->finish();
  result.causal = *causal;
  return result;
}

void check_finite_and_ordered(const Run& run) {
  double before = -1.0;
  for (const auto& poses : {run.causal, run.backend->trajectory().poses()}) {
    before = -1.0;
    for (const auto& [t, T] : poses) {
      REQUIRE(T.p.allFinite());
      REQUIRE(T.q.coeffs().allFinite());
      REQUIRE(t > before);
      before = t;
    }
  }
}

}  // namespace

TEST_CASE("The trajectory of a moving camera is estimated up to scale") {
  const Run result = run(observe(circling, 2.0), 2.0);
  REQUIRE(result.backend->status().state == RunState::ok);
  check_finite_and_ordered(result);
  CHECK(result.causal.size() > 20);
  CHECK(result.backend->map().size() == 50);
  const double t0 = result.backend->trajectory().start();
  const SE3 truth0 = circling(t0).inverse(), own0 = result.backend->pose(t0)->inverse();
  const double scale = (own0 * *result.backend->pose(1.5)).p.norm() / (truth0 * circling(1.5)).p.norm();
  for (double t = 0.1; t < 1.95; t += 0.05) {
    const SE3 error = (truth0 * circling(t)).inverse() *
                      SE3{(own0 * *result.backend->pose(t)).q, (own0 * *result.backend->pose(t)).p / scale};
    CHECK(error.p.norm() < 0.02);
    CHECK(evbench::so3::log(error.q).norm() < 0.01);
  }
}

TEST_CASE("Without a map there is a reason: nothing observed, one track, a camera at rest") {
  const auto all = observe(circling, 1.5);
  std::vector<UndistortedObservation> one;
  std::ranges::copy_if(all, std::back_inserter(one), [](const UndistortedObservation& z) { return z.track == 0; });
  for (const auto& observations : {std::vector<UndistortedObservation>{}, one, observe(resting, 1.5)}) {
    const Run result = run(observations, 1.5);
    CHECK(result.backend->status().state == RunState::failed);
    CHECK_FALSE(result.backend->status().reason.empty());
    CHECK(result.backend->trajectory().empty());
  }
}

TEST_CASE("A gap is reported as degraded, and the end of all observations as lost") {
  auto observations = observe(circling, 3.0);
  std::erase_if(observations, [](const UndistortedObservation& z) { return z.t > 1.5 && z.t < 1.9; });
  const Run gap = run(observations, 3.0);
  check_finite_and_ordered(gap);
  CHECK(gap.backend->status().state == RunState::degraded);
  std::erase_if(observations, [](const UndistortedObservation& z) { return z.t > 1.5; });
  const Run ended = run(observations, 3.0);
  check_finite_and_ordered(ended);
  CHECK(ended.backend->status().state == RunState::lost);
  CHECK(ended.backend->status().time == Approx(1.5).margin(0.1));
  CHECK(ended.backend->trajectory().end() < 1.7);
}

TEST_CASE("Outlier tracks are removed, and the estimate stays finite") {
  auto observations = observe(circling, 2.0);
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const auto x = static_cast<double>(i);
    if (observations[i].track % 4 == 0) observations[i].pixel = {1e6 * std::sin(x), -1e9 * std::cos(3.0 * x)};
  }
  const Run result = run(observations, 2.0);
  check_finite_and_ordered(result);
  CHECK(result.backend->status().state <= RunState::degraded);
  for (const evbench::Landmark& landmark : result.backend->map()) CHECK(landmark.track % 4 != 0);
}

TEST_CASE("The size of the batches does not change the result, to the last bit") {
  const auto observations = observe(circling, 1.5);
  const Run a = run(observations, 1.5, 0.01), b = run(observations, 1.5, 0.01), c = run(observations, 1.5, 0.3);
  for (const Run* other : {&b, &c}) {
    REQUIRE(other->causal.size() == a.causal.size());
    for (std::size_t i = 0; i < a.causal.size(); ++i) CHECK(other->causal[i].T.p == a.causal[i].T.p);
    CHECK(other->backend->pose(1.0)->p == a.backend->pose(1.0)->p);
  }
}
