#include "backends/gp_map/track_table.hpp"

#include "core/testing/catch2.hpp"

namespace evbench::gp_map {
namespace {

constexpr auto kNothing = [](const UndistortedObservation&) {};

void observe(TrackTable& tracks, TrackId id, double t) {
  tracks.receive({{{id, t, {10.0 + t, 20.0}, 0.5}}, {}, t});
  tracks.advance_to(t, kNothing);
}

}  // namespace

TEST_CASE("Observations wait until their time, and those of a landmark's track are of the landmark") {
  TrackTable tracks(2.0);
  tracks.receive({{{7, 0.1, {1.0, 2.0}, 0.5}, {7, 0.3, {3.0, 4.0}, 0.5}}, {}, 0.3});
  tracks.advance_to(0.2, kNothing);
  REQUIRE(tracks.waiting().observations(7).size() == 1);
  CHECK(tracks.take_observations().empty());
  tracks.become_landmark(7, 0);
  int asked = 0;
  tracks.advance_to(0.3, [&](const UndistortedObservation& z) { asked += z.track == 7; });
  const auto taken = tracks.take_observations();
  REQUIRE(taken.size() == 1);
  CHECK(taken.front().first == 0);
  CHECK(taken.front().second.t == 0.3);
  CHECK(taken.front().second.whitening.inverse_sigma() == Approx(1.0));  // 1/(2 · 0.5 px)
  CHECK(asked == 1);
  CHECK(tracks.waiting().observations(7).empty());
  CHECK(tracks.landmarks_in_view() == 1);
  CHECK(tracks.track_of(0) == 7);
}

TEST_CASE("A rejected landmark's track is reported once, and waits with all observations if recalled") {
  TrackTable tracks(1.0);
  observe(tracks, 1, 0.1);
  observe(tracks, 2, 0.11);
  tracks.remember();
  tracks.become_landmark(1, 0);
  tracks.become_landmark(2, 1);
  tracks.end_track_of(0, TrackTable::Role::outlier);
  observe(tracks, 1, 0.2);
  CHECK(tracks.take_observations().empty());
  CHECK(tracks.mismatched() == 1);
  CHECK(tracks.tracks_with_landmarks() == 1);
  TrackTable other = tracks;
  CHECK(tracks.take_outliers() == std::vector<TrackId>{1});
  CHECK(tracks.take_outliers().empty());
  other.recall([](int landmark) { return landmark == 1; });
  CHECK(other.take_outliers().empty());
  CHECK(other.find(1)->role == TrackTable::Role::waiting);
  CHECK(other.waiting().observations(1).size() == 2);
  CHECK(other.find(2)->role == TrackTable::Role::landmark);
}

TEST_CASE("A mismatched track is ignored until it ends") {
  TrackTable tracks(1.0);
  observe(tracks, 3, 0.1);
  tracks.become_landmark(3, 0);
  tracks.mismatch(3);
  observe(tracks, 3, 0.2);
  CHECK(tracks.take_observations().empty());
  CHECK(tracks.take_outliers() == std::vector<TrackId>{3});
  tracks.receive({{}, {{3, 0.25}}, 0.25});
  tracks.advance_to(0.25, kNothing);
  observe(tracks, 3, 0.3);
  CHECK(tracks.take_observations().size() == 1);
}

}  // namespace evbench::gp_map
