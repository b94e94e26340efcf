#include "bench/pipeline/stationary_detector.hpp"

#include <cmath>

#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

/// Ten tracks that move, each observed every 20 ms with a phase of its own, in batches of 10 ms.
TrackBatch moving(double until) {
  TrackBatch batch;
  batch.until = until;
  for (TrackId track = 0; track < 10; ++track) {
    const double t = until - 0.009 + 0.0009 * static_cast<double>(track);
    if ((static_cast<int>(std::lround(100.0 * until)) + track) % 2 == 0) {
      batch.observations.push_back({track, t, Vector2(10.0 + 50.0 * t, 20.0), 0.2});
    }
  }
  return batch;
}

TrackBatch silent(double until) {
  TrackBatch batch;
  batch.until = until;
  return batch;
}

}  // namespace

TEST_CASE("While a camera moves, nothing is added to what is seen of it") {
  StationaryDetector standstill(0.1);
  for (int i = 1; i <= 100; ++i) {
    TrackBatch batch = moving(0.01 * i);
    const std::size_t seen = batch.observations.size();
    standstill.apply(batch);
    CHECK(batch.observations.size() == seen);
    CHECK_FALSE(standstill.holds());
  }
  CHECK(standstill.spans().empty());
}

TEST_CASE("When live tracks fall silent they are held where they were, until they move again") {
  StationaryDetector standstill(0.1);
  TrackBatch batch;
  for (int i = 1; i <= 100; ++i) standstill.apply(batch = moving(0.01 * i));
  std::size_t held = 0;
  double before = 1.0;
  for (int i = 101; i <= 300; ++i) {
    standstill.apply(batch = silent(0.01 * i));
    for (const TrackObservation& z : batch.observations) {
      CHECK(z.t > before - 1e-12);
      CHECK(z.t <= batch.until);
      CHECK(z.pixel.x() == Approx(10.0 + 50.0).margin(1.5));
      CHECK(z.sigma == 0.5);
    }
    if (!batch.observations.empty()) before = batch.observations.back().t;
    held += batch.observations.size();
  }
  CHECK(held == Approx(10.0 * 50.0 * 1.9).epsilon(0.05));  // at 50 Hz from 0.1 s on
  CHECK(standstill.holds());
  standstill.apply(batch = moving(3.01));
  CHECK_FALSE(standstill.holds());
  REQUIRE(standstill.spans().size() == 1);
  CHECK(standstill.spans()[0].from == Approx(1.0).margin(0.01));
  CHECK(standstill.spans()[0].to == Approx(3.0).margin(0.06));
}

TEST_CASE("Tracks that have ended are not held, and few tracks say nothing of the camera") {
  StationaryDetector standstill(0.1);
  TrackBatch batch;
  for (int i = 1; i <= 100; ++i) standstill.apply(batch = moving(0.01 * i));
  batch = silent(1.005);
  for (TrackId track = 0; track < 5; ++track) batch.ended.push_back({track, 1.001});
  standstill.apply(batch);
  for (int i = 101; i <= 200; ++i) {
    standstill.apply(batch = silent(0.01 * i));
    CHECK(batch.observations.empty());
  }
  CHECK_FALSE(standstill.holds());
}

TEST_CASE("The time between the frames of a slow tracker is no standstill") {
  StationaryDetector standstill(0.1);
  for (int i = 1; i <= 500; ++i) {
    TrackBatch batch = silent(0.01 * i);
    if (i % 25 == 0) {
      for (TrackId track = 0; track < 10; ++track)
        batch.observations.push_back({track, batch.until, {1.0 * i, 2.0}, 1});
    }
    const std::size_t seen = batch.observations.size();
    standstill.apply(batch);
    if (i > 100) CHECK(batch.observations.size() == seen);
  }
}

TEST_CASE("One long batch is held like many short ones") {
  TrackBatch whole;
  StationaryDetector once(0.1), often(0.1);
  std::vector<TrackObservation> parts;
  for (int i = 1; i <= 300; ++i) {
    TrackBatch batch = i <= 100 || i > 200 ? moving(0.01 * i) : silent(0.01 * i);
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

/// After a second of motion and a silence: some tracks end, and from some other time on the others and ten new ones are
/// seen.
StationaryDetector after_silence(TrackId ending, double ends_at, double seen_again_at) {
  StationaryDetector standstill(0.1);
  TrackBatch batch;
  for (int i = 1; i <= 100; ++i) standstill.apply(batch = moving(0.01 * i));
  for (int i = 101; i <= 600; ++i) {
    batch = silent(0.01 * i);
    if (std::abs(batch.until - ends_at) < 0.005) {
      for (TrackId track = 0; track < ending; ++track) batch.ended.push_back({track, batch.until - 0.001});
    }
    if (batch.until > seen_again_at - 0.005) {
      for (TrackId track = ending; track < 20; ++track) {
        batch.observations.push_back({track, batch.until - 0.002, Vector2(60.0, 20.0), 0.2});
      }
    }
    standstill.apply(batch);
    if (standstill.refuted()) break;
  }
  return standstill;
}

}  // namespace

TEST_CASE("A stand after which most tracks end unseen was none") {
  const StationaryDetector refuted = after_silence(8, 3.02, 3.0);
  REQUIRE(refuted.refuted());
  CHECK(refuted.refuted()->span.from == Approx(1.0).margin(0.01));
  CHECK(refuted.refuted()->span.to == Approx(3.0).margin(0.06));
  CHECK(refuted.refuted()->survivors.size() == 4);  // when more than half are gone
  CHECK(refuted.spans().size() == 1);
  StationaryDetector later = refuted;
  TrackBatch batch = moving(3.1);
  later.apply(batch);
  CHECK(later.spans().empty());
  CHECK(after_silence(8, 2.9, 3.0).refuted());  // whichever comes first
}

TEST_CASE("A stand is one where most tracks go on, or end while nothing else is seen") {
  for (const StationaryDetector& standstill :
       {after_silence(4, 3.02, 3.0), after_silence(8, 2.0, 4.0), after_silence(8, 3.3, 3.0)}) {
    CHECK_FALSE(standstill.refuted());
    REQUIRE_FALSE(standstill.spans().empty());
    CHECK(standstill.spans()[0].from == Approx(1.0).margin(0.01));
  }
}
