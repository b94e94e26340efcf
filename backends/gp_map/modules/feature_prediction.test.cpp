#include <cmath>
#include <map>
#include <set>

#include "backends/gp_map/gp_map.hpp"
#include "backends/gp_map/testing/tracked_scene.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {

TEST_CASE("Every landmark that was expected once is expected whenever it is in view, at any turn rate of the camera",
          "[long]") {
  const char* turning = R"({"motion": {"kind": "smooth_random", "max_frequency": 2.0, "rotation_amplitude": 0.6},
                            "tracks": {"lifetime": [0.3, 1.0], "noise": 0.1}})";
  constexpr double kExchange = 0.005;  // [s]
  for (const bool per_observation : {false, true}) {
    const testing::TrackedScene scene(4.0, turning);
    BackEndContext context;
    context.camera = scene.camera();
    Options options;
    options.per_observation = per_observation;
    GpMap backend(options, context);
    std::set<TrackId> known;
    int in_view = 0, missing = 0, back = 0;
    std::map<TrackId, double> last;
    auto z = scene.observations().begin();
    for (double t = kExchange; t < scene.duration(); t += kExchange) {
      UndistortedBatch batch{{}, {}, t};
      for (; z != scene.observations().end() && z->t <= t; ++z) {
        batch.observations.push_back(*z);
        last[z->track] = z->t;
      }
      std::erase_if(last, [&](const auto& track) {
        const bool gone = t - track.second > 0.05;
        if (gone) batch.ended.push_back({track.first, t});
        return gone;
      });
      backend.advance(batch);
      const BackEndFeedback feedback = backend.feedback({true, false, true});
      for (const TrackId id : feedback.outliers) known.erase(id);
      std::set<TrackId> expected;
      for (const UndistortedFeature& feature : feedback.expected) expected.insert(feature.track);
      if (feedback.newest) {
        const SE3 T = extrapolate(*feedback.newest, t - feedback.newest->t).T.inverse();
        for (const Landmark& landmark : backend.map()) {
          const Vector3 point = T * landmark.position;
          if (!known.contains(landmark.track) || point.z() < 0.01) continue;
          const Vector2 pixel = scene.camera().project(point);
          if (std::abs(pixel.x() - scene.camera().cx) > scene.camera().cx) continue;
          if (std::abs(pixel.y() - scene.camera().cy) > scene.camera().cy) continue;
          ++in_view;
          missing += !expected.contains(landmark.track);
          back += !last.contains(landmark.track);
        }
      }
      known.insert(expected.begin(), expected.end());
    }
    CHECK(in_view > 10000);
    CHECK(back > 1000);
    CHECK(missing == 0);
  }
}

}  // namespace evbench::gp_map
