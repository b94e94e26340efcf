// The scale of the initial map is held as long as the map exists.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "backends/gp_map/gp_map.hpp"
#include "backends/gp_map/testing/tracked_scene.hpp"
#include "core/smoother/factors.hpp"
#include "core/support/index.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {
namespace {

using testing::run;
using testing::TrackedScene;

/// The true positions of the scale anchor's landmarks.
std::vector<Vector3> anchored_points(const TrackedScene& scene, const GpMap& backend) {
  std::vector<Vector3> points;
  for (const int j : backend.graph().anchor.landmarks) {
    for (const Landmark& landmark : backend.map()) {
      if (landmark.position == backend.graph().landmarks[index(j)].position)
        points.push_back(scene.point(landmark.track));
    }
  }
  REQUIRE(points.size() == backend.graph().anchor.landmarks.size());
  return points;
}

/// The scale from the estimate to the truth according to the anchor's landmarks alone: in units of the truth, too, they
/// have the mean nearness of the anchor.
double anchored_scale(const TrackedScene& scene, const GpMap& backend) {
  ScaleAnchor anchor = backend.graph().anchor;
  const double estimated_unit = anchor.unit;
  anchor.origin = scene.ground_truth().pose(backend.trajectory().start())->p;
  const std::vector<Vector3> points = anchored_points(scene, backend);
  double low = 1e-3, high = 1e3;  // by bisection: nearness grows with the unit
  for (int i = 0; i < 60; ++i) {
    const double scale = std::sqrt(low * high);
    anchor.unit = scale * estimated_unit;
    double nearness = 0.0;
    for (const Vector3& point : points) nearness += anchor.nearness(point);
    (nearness < anchor.mean_nearness * static_cast<double>(points.size()) ? low : high) = scale;
  }
  return low;
}

}  // namespace

TEST_CASE("A prior a hundred times stronger or weaker does not change the anchored scale", "[long]") {
  const TrackedScene scene(5.0, R"({"tracks": {"lifetime": [1.0, 3.0]}})");
  for (const char* options : {"{}", R"({"qc_scale": 100})", R"({"qc_scale": 0.01})"}) {
    INFO(options);
    const auto result = run(scene, {.backend = options});
    CHECK(result.scores.alignment.transform.scale == Approx(anchored_scale(scene, *result.backend)).epsilon(0.05));
  }
}

TEST_CASE("The landmarks of the scale anchor keep their mean nearness", "[slow]") {
  const TrackedScene scene(5.0);
  const auto result = run(scene);
  CHECK(std::abs(linearise_anchor(result.backend->graph()).e) < 5.0);  // in sigmas of 1e-4
}

TEST_CASE("Near landmarks, whose distances are known best, anchor the scale", "[slow]") {
  const TrackedScene scene(2.0, R"({"scene": {"near": 1, "far": 10}, "tracks": {"lifetime": [3.0, 4.0]}})");
  const auto result = run(scene);
  const Vector3 origin = scene.ground_truth().pose(result.backend->trajectory().start())->p;
  const auto nearness = [&](const Vector3& point) { return 1.0 / (point - origin).norm(); };
  double sum = 0.0, of_all = 0.0;
  const std::vector<Vector3> anchoring = anchored_points(scene, *result.backend);
  for (const Vector3& point : anchoring) sum += nearness(point);
  for (const Landmark& landmark : result.backend->map()) of_all += nearness(scene.point(landmark.track));
  const double map_size = static_cast<double>(result.backend->map().size());
  CHECK(sum / static_cast<double>(anchoring.size()) > 1.3 * of_all / map_size);
}

TEST_CASE("When most landmarks of the scale anchor turn out to be outliers, others are added to it", "[slow]") {
  // Only 25 tracks make the initial map; 40 others come at 0.6 s; from 0.9 s on the first ones jump away in turn.
  const TrackedScene scene(6.0,
                           R"({"motion": {"max_frequency": 0.3}, "tracks": {"lifetime": [7.0, 8.0], "alive": 65}})");
  constexpr TrackId kFirst = 25;
  std::vector<UndistortedObservation> observations;
  for (UndistortedObservation z : scene.observations()) {
    if (z.track >= kFirst && z.t < 0.6) continue;
    const double angle = static_cast<double>(z.track);
    if (z.track < kFirst && z.t > 0.9 + 0.005 * angle) z.pixel += 100.0 * Vector2(std::cos(angle), std::sin(angle));
    observations.push_back(z);
  }
  BackEndContext context;
  context.camera = scene.camera();
  GpMap backend({}, context);
  backend.advance({observations, {}, 6.0});
  backend.finish();
  CHECK(std::ranges::count(backend.counters(), std::pair<std::string, std::int64_t>("scale_anchored_anew", 1)) == 1);
  CHECK(backend.graph().anchor.landmarks.size() > 10);
  CHECK(backend.status().state == RunState::ok);
  const Scores scores = score(scene.ground_truth(), backend.trajectory(), {.association = "interpolated"});
  CHECK(scores.ate.trans_percent < 2.0);
}

}  // namespace evbench::gp_map
