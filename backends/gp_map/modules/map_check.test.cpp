#include "backends/gp_map/modules/map_check.hpp"

#include "backends/gp_map/testing/small_scene.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {
namespace {

/// Live tracks of which the first ones are landmarks and the others were rejected.
TrackTable table_with(int landmarks, int outliers) {
  TrackTable tracks(1.0);
  UndistortedBatch batch;
  batch.until = 1.0;
  for (TrackId id = 0; id < landmarks + outliers; ++id) batch.observations.push_back({id, 0.05, {100.0, 90.0}, 1.0});
  tracks.receive(batch);
  tracks.advance_to(1.0, [](const UndistortedObservation&) {});
  for (int j = 0; j < landmarks + outliers; ++j) tracks.become_landmark(j, j);
  for (int j = landmarks; j < landmarks + outliers; ++j) tracks.end_track_of(j, TrackTable::Role::outlier);
  return tracks;
}

}  // namespace

TEST_CASE("A map that most tracks fit is confirmed once it was searched, and stays so") {
  Counters counters;
  const Estimate tentative(testing::small_scene({1.0, 2.0}), {}, 3, 5.0, counters);
  MapCheck check;
  const TrackTable good = table_with(20, 5), poor = table_with(5, 20);
  check.follow(good, false);
  CHECK(check.is_pending(tentative));
  check.follow(poor, true);
  CHECK(check.is_pending(tentative));
  check.follow(good, true);
  CHECK_FALSE(check.is_pending(tentative));
  check.follow(poor, true);
  CHECK_FALSE(check.is_pending(tentative));
}

TEST_CASE("A map that most tracks do not fit is pending until it is no longer tentative, or the data end") {
  Counters counters;
  const Estimate tentative(testing::small_scene({1.0, 2.0}), {}, 3, 5.0, counters);
  const Estimate old(testing::small_scene({1.0, 2.0}), {}, 3, 0.0, counters);
  MapCheck check;
  check.follow(table_with(5, 20), true);
  CHECK(check.is_pending(tentative));
  CHECK_FALSE(check.is_pending(old));
  check.confirm();
  CHECK_FALSE(check.is_pending(tentative));
}

}  // namespace evbench::gp_map
