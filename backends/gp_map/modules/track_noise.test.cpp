#include <algorithm>
#include <cmath>
#include <numbers>

#include "backends/gp_map/gp_map.hpp"
#include "backends/gp_map/testing/tracked_scene.hpp"
#include "core/support/index.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {

using testing::TrackedScene;

TEST_CASE("While running, a track with larger errors than the others counts less", "[slow]") {
  const TrackedScene scene(8.0, R"({"tracks": {"lifetime": [2.0, 3.0]}})");
  const auto errs = [](TrackId track) { return track % 4 == 0; };
  constexpr double kPeriod = 0.3, kAmplitude = 4.0;  // [s], [px]
  std::vector<UndistortedObservation> observations;
  for (UndistortedObservation z : scene.observations()) {
    const double phase = 2.0 * std::numbers::pi * (z.t / kPeriod + 0.1 * static_cast<double>(z.track));
    if (errs(z.track)) z.pixel += kAmplitude * std::cos(phase) * Vector2(std::cos(z.track), std::sin(z.track));
    observations.push_back(z);
  }
  BackEndContext context;
  context.camera = scene.camera();
  Options options;
  options.final_iterations = 0;
  GpMap backend(options, context);
  backend.advance({observations, {}, scene.duration()});
  backend.finish();
  int erring = 0, downweighted = 0, sound = 0, unchanged = 0;
  for (const Landmark& landmark : backend.map()) {
    const auto found =
        std::ranges::find(backend.graph().landmarks, landmark.position, &FactorGraph::Landmark::position);
    REQUIRE(found != backend.graph().landmarks.end());
    const auto& states = backend.graph().states;
    const double seen = states[index(found->intervals.back())].t - states[index(found->intervals.front())].t;
    if (seen < 1.5) continue;
    errs(landmark.track) ? ++erring : ++sound;
    if (errs(landmark.track))
      downweighted += found->sigma_scale > 1.5;
    else
      unchanged += found->sigma_scale < 1.5;
  }
  INFO(downweighted << " of " << erring << ", " << unchanged << " of " << sound);
  CHECK(erring >= 5);
  CHECK(downweighted > 0.8 * erring);
  CHECK(unchanged > 0.9 * sound);
}

}  // namespace evbench::gp_map
