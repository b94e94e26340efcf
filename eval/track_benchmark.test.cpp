#include "eval/track_benchmark.hpp"

#include <algorithm>

#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;

namespace {

std::vector<TrackObservation> observations_of(const Json& rows) {
  std::vector<TrackObservation> observations;
  for (const Json& row : rows) {
    observations.push_back({row[0].get<TrackId>(), row[1].get<double>(), {row[2].get<double>(), row[3].get<double>()}});
  }
  std::ranges::stable_sort(observations, {}, &TrackObservation::t);
  return observations;
}

/// A true track along x at 10 px/s from 0 to 1 s.
std::vector<TrackObservation> straight(TrackId id, double end = 1.0, double off = 0.0) {
  std::vector<TrackObservation> track;
  for (double t = 0.0; t < end + 1e-9; t += 0.1) track.push_back({id, t, {10.0 * t, t > 0.55 ? off : 0.0}});
  return track;
}

}  // namespace

TEST_CASE("Metrics of perturbed tracks equal a transcription of their definitions") {
  const Json expected = parse_json(testing::read_file(EVBENCH_EVAL_TESTING "/expected_track_benchmark.json"));
  const auto truth = observations_of(expected.at("truth")), tracks = observations_of(expected.at("tracks"));
  for (const auto& [name, protocol] : {std::pair{"full", TrackProtocol::full}, {"cropped", TrackProtocol::cropped}}) {
    const TrackBenchmark found = benchmark_tracks(truth, tracks, protocol);
    const Json& values = expected.at(name);
    INFO(name);
    CHECK(found.tracks == values.at("tracks").get<std::size_t>());
    CHECK(found.expected_age == Approx(values.at("expected_age").get<double>()).epsilon(1e-9));
    CHECK(found.inlier_ratio == Approx(values.at("inlier_ratio").get<double>()).epsilon(1e-9));
    CHECK(found.age == Approx(values.at("age").get<double>()).epsilon(1e-9));
    CHECK(found.age_5px == Approx(values.at("age_5px").get<double>()).epsilon(1e-9));
    CHECK(found.error_5px == Approx(values.at("error_5px").get<double>()).epsilon(1e-9));
  }
}

TEST_CASE("A track that stops early and accurately has age 1 when cropped, and its share of the time when not") {
  const auto truth = straight(3), early = straight(3, 0.4);
  CHECK(benchmark_tracks(truth, early, TrackProtocol::cropped).expected_age == 1.0);
  const TrackBenchmark full = benchmark_tracks(truth, early, TrackProtocol::full);
  CHECK(full.expected_age == Approx(0.4));
  CHECK(full.inlier_ratio == 1.0);
}

TEST_CASE("A track's age ends at its first error beyond the threshold, and a missing track has none") {
  auto truth = straight(1);
  const auto off = straight(1, 1.0, 7.5);  // from 0.6 s on
  CHECK(benchmark_tracks(truth, off, TrackProtocol::full).age_5px == Approx(0.5));
  CHECK(benchmark_tracks(truth, off, TrackProtocol::full).expected_age == Approx((7 * 0.5 + 24 * 1.0) / 31));
  CHECK(benchmark_tracks(truth, off, TrackProtocol::cropped).age_5px == Approx(0.4));
  const auto other = straight(2);
  truth.insert(truth.end(), other.begin(), other.end());
  CHECK(benchmark_tracks(truth, off, TrackProtocol::full).tracks == 2);
  CHECK(benchmark_tracks(truth, off, TrackProtocol::full).inlier_ratio == Approx(0.5));
  CHECK(benchmark_tracks(truth, off, TrackProtocol::cropped).tracks == 1);
  CHECK_THROWS_AS(benchmark_tracks(truth, straight(9), TrackProtocol::full), InputError);
}
