#include "bench/pipeline/stationary_detector.hpp"

#include <cmath>

#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

/// Ten tracks that move, each observed every 20 ms with a phase of its own, in batches of 10 ms.
UndistortedBatch moving_batch(double until) {
  UndistortedBatch batch;
  batch.until = until;
  for (TrackId track = 0; track < 10; ++track) {
    const double t = until - 0.009 + 0.0009 * static_cast<double>(track);
    if ((static_cast<int>(std::lround(100.0 * until)) + track) % 2 == 0) {
      batch.observations.push_back({track, t, Vector2(10.0 + 50.0 * t, 20.0), 0.2});
    }
  }
  return batch;
}

UndistortedBatch empty_batch(double until) {
  UndistortedBatch batch;
  batch.until = until;
  return batch;
}

}  // namespace

TEST_CASE("While the camera moves, no observations are added") {
  StationaryDetector detector(0.1);
  for (int i = 1; i <= 100; ++i) {
    UndistortedBatch batch = moving_batch(0.01 * i);
    const std::size_t seen = batch.observations.size();
    detector.apply(batch);
    CHECK(batch.observations.size() == seen);
    CHECK_FALSE(detector.is_stationary());
  }
  CHECK(detector.periods().empty());
}

TEST_CASE("When live tracks are not observed, their last positions are repeated until they move again") {
  StationaryDetector detector(0.1);
  UndistortedBatch batch;
  for (int i = 1; i <= 100; ++i) detector.apply(batch = moving_batch(0.01 * i));
  std::size_t repeated = 0;
  double before = 1.0;
  for (int i = 101; i <= 300; ++i) {
    detector.apply(batch = empty_batch(0.01 * i));
    for (const UndistortedObservation& z : batch.observations) {
      CHECK(z.t > before - 1e-12);
      CHECK(z.t <= batch.until);
      CHECK(z.pixel.x() == Approx(10.0 + 50.0).margin(1.5));
      CHECK(z.noise == 0.5);
    }
    if (!batch.observations.empty()) before = batch.observations.back().t;
    repeated += batch.observations.size();
  }
  CHECK(repeated == Approx(10.0 * 50.0 * 1.9).epsilon(0.05));  // at 50 Hz from 0.1 s on
  CHECK(detector.is_stationary());
  detector.apply(batch = moving_batch(3.01));
  CHECK_FALSE(detector.is_stationary());
  REQUIRE(detector.periods().size() == 1);
  CHECK(detector.periods()[0].from == Approx(1.0).margin(0.01));
  CHECK(detector.periods()[0].to == Approx(3.0).margin(0.06));
}

TEST_CASE("Ended tracks are not repeated, and few tracks are no evidence of a stationary camera") {
  StationaryDetector detector(0.1);
  UndistortedBatch batch;
  for (int i = 1; i <= 100; ++i) detector.apply(batch = moving_batch(0.01 * i));
  batch = empty_batch(1.005);
  for (TrackId track = 0; track < 5; ++track) batch.ended.push_back({track, 1.001});
  detector.apply(batch);
  for (int i = 101; i <= 200; ++i) {
    detector.apply(batch = empty_batch(0.01 * i));
    CHECK(batch.observations.empty());
  }
  CHECK_FALSE(detector.is_stationary());
}

TEST_CASE("The time between the frames of a slow tracker is no stationary period") {
  StationaryDetector detector(0.1);
  for (int i = 1; i <= 500; ++i) {
    UndistortedBatch batch = empty_batch(0.01 * i);
    if (i % 25 == 0) {
      for (TrackId track = 0; track < 10; ++track)
        batch.observations.push_back({track, batch.until, {1.0 * i, 2.0}, 1});
    }
    const std::size_t seen = batch.observations.size();
    detector.apply(batch);
    if (i > 100) CHECK(batch.observations.size() == seen);
  }
}

TEST_CASE("In one long batch the same observations are added as in many short ones") {
  UndistortedBatch whole;
  StationaryDetector once(0.1), often(0.1);
  std::vector<UndistortedObservation> parts;
  for (int i = 1; i <= 300; ++i) {
    UndistortedBatch batch = i <= 100 || i > 200 ? moving_batch(0.01 * i) : empty_batch(0.01 * i);
    if (i == 151) batch.ended = {{0, 1.503}, {1, 1.504}, {2, 1.505}};
    whole.ended.insert(whole.ended.end(), batch.ended.begin(), batch.ended.end());
    whole.observations.insert(whole.observations.end(), batch.observations.begin(), batch.observations.end());
    often.apply(batch);
    parts.insert(parts.end(), batch.observations.begin(), batch.observations.end());
  }
  whole.until = 3.0;
  once.apply(whole);
  REQUIRE(whole.observations.size() == parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    CHECK(whole.observations[i].t == parts[i].t);
    CHECK(whole.observations[i].track == parts[i].track);
  }
}

namespace {

/// A second of motion, then no observations; at one time some of the tracks end, and from another time on the rest and
/// ten new ones are observed.
StationaryDetector after_gap(TrackId ending, double ends_at, double seen_again_at) {
  StationaryDetector detector(0.1);
  UndistortedBatch batch;
  for (int i = 1; i <= 100; ++i) detector.apply(batch = moving_batch(0.01 * i));
  for (int i = 101; i <= 600; ++i) {
    batch = empty_batch(0.01 * i);
    if (std::abs(batch.until - ends_at) < 0.005) {
      for (TrackId track = 0; track < ending; ++track) batch.ended.push_back({track, batch.until - 0.001});
    }
    if (batch.until > seen_again_at - 0.005) {
      for (TrackId track = ending; track < 20; ++track) {
        batch.observations.push_back({track, batch.until - 0.002, Vector2(60.0, 20.0), 0.2});
      }
    }
    detector.apply(batch);
    if (detector.rejected()) break;
  }
  return detector;
}

}  // namespace

TEST_CASE("A stationary period is rejected if most tracks end when observations return") {
  const StationaryDetector detector = after_gap(8, 3.02, 3.0);
  REQUIRE(detector.rejected());
  CHECK(detector.rejected()->period.from == Approx(1.0).margin(0.01));
  CHECK(detector.rejected()->period.to == Approx(3.0).margin(0.06));
  CHECK(detector.rejected()->surviving_tracks.size() == 4);  // when more than half have ended
  CHECK(detector.periods().size() == 1);
  StationaryDetector later = detector;
  UndistortedBatch batch = moving_batch(3.1);
  later.apply(batch);
  CHECK(later.periods().empty());
  CHECK(after_gap(8, 2.9, 3.0).rejected());  // whichever comes first
}

TEST_CASE("A stationary period is kept if most tracks go on, or end while nothing else is observed") {
  for (const StationaryDetector& detector : {after_gap(4, 3.02, 3.0), after_gap(8, 2.0, 4.0), after_gap(8, 3.3, 3.0)}) {
    CHECK_FALSE(detector.rejected());
    REQUIRE_FALSE(detector.periods().empty());
    CHECK(detector.periods()[0].from == Approx(1.0).margin(0.01));
  }
}
