#include <algorithm>
#include <cmath>
#include <map>

#include "backends/gp_map/gp_map.hpp"
#include "backends/gp_map/testing/tracked_scene.hpp"
#include "core/support/index.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {

using testing::TrackedScene;

TEST_CASE("A drifting track keeps its beginning as a landmark, and other tracks are kept completely", "[slow]") {
  const TrackedScene scene(10.0, R"({"tracks": {"lifetime": [4.0, 5.0]}})");
  constexpr double kAfter = 1.0, kSpeed = 3.0;  // [s], [px/s]: its mean error stays far below the outliers'
  const auto drifts = [](TrackId track) { return track % 5 == 0; };
  std::map<TrackId, double> begin, end;
  std::vector<UndistortedObservation> observations;
  for (UndistortedObservation z : scene.observations()) {
    begin.try_emplace(z.track, z.t);
    end[z.track] = z.t;
    const double angle = static_cast<double>(z.track), since = z.t - begin[z.track] - kAfter;
    if (drifts(z.track) && since > 0.0) z.pixel += kSpeed * since * Vector2(std::cos(angle), std::sin(angle));
    observations.push_back(z);
  }
  BackEndContext context;
  context.camera = scene.camera();
  GpMap backend({}, context);
  backend.advance({observations, {}, scene.duration()});
  backend.finish();
  int drifted = 0, beginnings = 0, sound = 0, whole = 0;
  for (const Landmark& landmark : backend.map()) {
    if (end[landmark.track] < begin[landmark.track] + 2.5) continue;
    const auto& found =
        std::ranges::find(backend.graph().landmarks, landmark.position, &FactorGraph::Landmark::position);
    const double last = backend.graph().states[index(found->intervals.back())].t;
    if (drifts(landmark.track)) {
      ++drifted;
      beginnings += last > begin[landmark.track] + 0.5 && last < end[landmark.track] - 0.5;
    } else {
      ++sound;
      whole += last > end[landmark.track] - 0.2;
    }
  }
  CHECK(drifted >= 18);
  CHECK(beginnings >= drifted - 1);
  CHECK(sound > 20);
  CHECK(whole == sound);
}

}  // namespace evbench::gp_map
