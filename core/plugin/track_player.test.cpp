#include "core/plugin/track_player.hpp"

#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

TrackObservation seen(TrackId track, double t) { return {track, t, Vector2(1, 2), 1.0}; }

}  // namespace

TEST_CASE("Known tracks are played once, up to the requested time, and end with their last observation") {
  const std::vector<TrackObservation> all = {seen(1, 0.1), seen(2, 0.2), seen(1, 0.3), seen(2, 0.3), seen(2, 0.9)};
  TrackPlayer player(all);
  TrackBatch batch;
  CHECK(player.advance({0.3}, batch));
  CHECK(batch.until == 0.3);
  CHECK(batch.observations.size() == 4);
  REQUIRE(batch.ended.size() == 1);
  CHECK(batch.ended[0].track == 1);
  CHECK(batch.ended[0].t == 0.3);
  CHECK(player.advance({0.8}, batch));
  CHECK(batch.observations.empty());
  CHECK(batch.ended.empty());
  CHECK_FALSE(player.advance({2.0}, batch));
  CHECK(batch.until == 2.0);
  CHECK(batch.observations.size() == 1);
  CHECK(batch.ended.at(0).track == 2);
  CHECK_FALSE(player.advance({3.0}, batch));
  CHECK(batch.observations.empty());
}

TEST_CASE("Known tracks end at the given times, possibly more than once, and otherwise with their last observation") {
  const std::vector<TrackObservation> all = {seen(1, 0.1), seen(2, 0.2), seen(1, 0.5), seen(3, 0.6)};
  TrackPlayer player(all, {{2, 0.4}, {1, 0.3}, {9, 0.2}, {2, 0.1}, {3, 0.9}});
  TrackBatch batch;
  std::vector<std::pair<TrackId, double>> ended;
  for (const double t : {0.45, 0.7, 1.0}) {
    CHECK(player.advance({t}, batch) == (t < 1.0));
    for (const TrackEnd& end : batch.ended) ended.emplace_back(end.track, end.t);
  }
  CHECK(ended == std::vector<std::pair<TrackId, double>>{{1, 0.3}, {2, 0.4}, {1, 0.5}, {3, 0.9}});
}

TEST_CASE("A batch limited in number ends at the time of its last observation and contains all of that time") {
  const std::vector<TrackObservation> all = {seen(1, 0.1), seen(2, 0.2), seen(3, 0.2), seen(4, 0.3)};
  TrackPlayer player(all);
  TrackBatch batch;
  CHECK(player.advance({1.0, 2}, batch));
  CHECK(batch.until == 0.2);
  CHECK(batch.observations.size() == 3);
  CHECK_FALSE(player.advance({1.0, 2}, batch));
  CHECK(batch.until == 1.0);
  CHECK(batch.observations.size() == 1);
}

TEST_CASE("Without tracks there is nothing to play") {
  TrackPlayer player;
  TrackBatch batch;
  CHECK_FALSE(player.advance({1.0}, batch));
  CHECK(batch.until == 1.0);
}
