#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "core/plugin/registry.hpp"

using namespace evbench;

// What every back-end must do, whatever its options: one battery over all that are registered.

namespace {

using Observations = std::vector<TrackObservation>;

/// A simulated sequence of 3 s, seen by an undistorted camera.
class Sequence {
 public:
  explicit Sequence(const Json& options = Json::object()) {
    Json config = {{"duration", 3},
                   {"motion", {{"kind", "robot_arm"}, {"period", 3}}},
                   {"tracks", {{"alive", 50}, {"rate", {50, 100}}, {"lifetime", {2, 5}}}}};
    config.merge_patch(options);
    source_ = Registry<Source>::instance().find("simulation", "test").make(config, "test", {1, ""});
    const auto tracks = *source_->true_tracks();
    observations.assign(tracks.begin(), tracks.end());
  }
  const Camera& camera() const { return source_->camera(); }

  Observations observations;

 private:
  std::unique_ptr<Source> source_;
};

/// Everything that a back-end says of its estimate.
struct Estimate {
  Status status;
  PoseTrajectory trajectory, online;
  std::vector<Landmark> map;
  std::vector<UpdateRecord> updates;
};

Estimate estimate(const std::string& name, const Sequence& sequence, const Observations& observations,
                  double end = 3.0) {
  BackEndContext context;
  context.camera = sequence.camera().pinhole;
  context.seed = 1;
  const auto backend = Registry<BackEnd>::instance().find(name, "test").make(Json::object(), "test: backend", context);
  auto next = observations.begin();
  for (double until = 0.01; until < end + 0.005; until += 0.01) {
    const auto last =
        std::upper_bound(next, observations.end(), until, [](double t, const TrackObservation& z) { return t < z.t; });
    backend->observe({next, last});
    backend->advance(until);
    backend->feedback();
    next = last;
  }
  backend->finish();
  return {backend->status(),
          backend->trajectory(),
          backend->online(),
          backend->map(),
          {backend->updates().begin(), backend->updates().end()}};
}

void check_finite_and_ordered(const Estimate& estimate, double end = 3.0) {
  for (const PoseTrajectory* trajectory : {&estimate.trajectory, &estimate.online}) {
    double before = -1.0;
    for (const auto& [t, T] : trajectory->poses()) {
      REQUIRE(T.p.allFinite());
      REQUIRE(T.q.coeffs().allFinite());
      REQUIRE(t > before);
      REQUIRE(t <= end + 0.1);
      before = t;
    }
  }
  for (const Landmark& landmark : estimate.map) REQUIRE(landmark.position.allFinite());
  for (const UpdateRecord& update : estimate.updates) {
    REQUIRE(std::isfinite(update.cost.value_or(0.0)));
    REQUIRE(update.t <= end + 0.1);
  }
}

/// A run that is not fine says why; one that failed has nothing to show.
void check_status(const Estimate& estimate) {
  if (estimate.status.state != RunState::ok) {
    CHECK_FALSE(estimate.status.reason.empty());
    CHECK(std::isfinite(estimate.status.time));
  }
  if (estimate.status.state == RunState::failed) CHECK(estimate.trajectory.empty());
  if (estimate.status.state <= RunState::degraded) CHECK_FALSE(estimate.trajectory.empty());
}

template <class Test>
void for_each_backend(Test test) {
  REQUIRE(Registry<BackEnd>::instance().entries().size() >= 2);
  for (const auto& [name, entry] : Registry<BackEnd>::instance().entries()) {
    INFO(name);
    test(name);
  }
}

Observations only(const Observations& all, bool (*wanted)(const TrackObservation&)) {
  Observations result;
  std::ranges::copy_if(all, std::back_inserter(result), wanted);
  return result;
}

}  // namespace

TEST_CASE("Every back-end follows a good sequence in time order and shows a map") {
  const Sequence sequence;
  for_each_backend([&](const std::string& name) {
    const Estimate result = estimate(name, sequence, sequence.observations);
    check_finite_and_ordered(result);
    check_status(result);
    CHECK(result.status.state <= RunState::degraded);
    CHECK(result.trajectory.end() > 2.5);
    CHECK(result.map.size() > 10);
    CHECK_FALSE(result.online.empty());
    CHECK_FALSE(result.updates.empty());
  });
}

TEST_CASE(
    "Every back-end ends as failed, with a reason, without observations, with one track, or with one observation") {
  const Sequence sequence;
  for_each_backend([&](const std::string& name) {
    const auto one_track = only(sequence.observations, [](const TrackObservation& z) { return z.track == 0; });
    REQUIRE(one_track.size() > 20);
    for (const Observations& observations : {Observations{}, one_track, Observations{one_track.front()}}) {
      const Estimate result = estimate(name, sequence, observations);
      CHECK(result.status.state == RunState::failed);
      check_status(result);
      check_finite_and_ordered(result);
    }
  });
}

TEST_CASE("Every back-end survives a gap without observations and says so") {
  const Sequence sequence;
  for_each_backend([&](const std::string& name) {
    const auto with_gap = only(sequence.observations, [](const TrackObservation& z) { return z.t < 1.8 || z.t > 2.1; });
    const Estimate result = estimate(name, sequence, with_gap);
    check_finite_and_ordered(result);
    check_status(result);
    CHECK(result.status.state != RunState::ok);
    CHECK(result.status.state != RunState::failed);
    CHECK((result.status.state == RunState::lost || !result.status.degraded.empty()));
  });
}

TEST_CASE("Every back-end keeps what it had when observations end before the sequence, and says so") {
  const Sequence sequence;
  for_each_backend([&](const std::string& name) {
    const auto first = only(sequence.observations, [](const TrackObservation& z) { return z.t < 2.0; });
    const Estimate result = estimate(name, sequence, first, 6.0);
    check_finite_and_ordered(result, 6.0);
    check_status(result);
    CHECK(result.status.state == RunState::lost);
    CHECK(result.status.time > 1.5);
    CHECK(result.trajectory.end() > 1.5);
  });
}

TEST_CASE("Every back-end makes no map out of a camera that stands still, and says why") {
  const Sequence sequence(Json{{"motion", {{"hold", {0, 3}}}}});
  for_each_backend([&](const std::string& name) {
    const Estimate result = estimate(name, sequence, sequence.observations);
    check_finite_and_ordered(result);
    check_status(result);
    CHECK(result.status.state == RunState::failed);
  });
}

TEST_CASE("Every back-end stays finite when tracks are wild") {
  const Sequence sequence;
  for_each_backend([&](const std::string& name) {
    Observations wild = sequence.observations;
    for (std::size_t i = 0; i < wild.size(); ++i) {
      if (wild[i].track % 4 == 0) wild[i].pixel = {1e6 * std::sin(double(i)), -1e9 * std::cos(3.0 * double(i))};
    }
    const Estimate result = estimate(name, sequence, wild);
    check_finite_and_ordered(result);
    check_status(result);
  });
}

TEST_CASE("Every back-end's online poses are told at their own times, and stay") {
  const Sequence sequence;
  for_each_backend([&](const std::string& name) {
    constexpr double cut = 2.0, latency = 0.1;  // [s]; a frame is complete after its own time
    const auto until_cut = only(sequence.observations, [](const TrackObservation& z) { return z.t <= 2.0; });
    const auto early = estimate(name, sequence, until_cut, cut).online.poses();
    const auto all = estimate(name, sequence, sequence.observations).online.poses();
    REQUIRE_FALSE(early.empty());
    REQUIRE(all.size() > early.size());
    std::size_t compared = 0;
    for (; compared < early.size() && early[compared].t < cut - latency; ++compared) {
      REQUIRE(all[compared].t == early[compared].t);
      REQUIRE(all[compared].T.p == early[compared].T.p);
    }
    CHECK(compared > 10);
    // The first one is told when there is a map: ending the data just after it must leave it there.
    const double told = all.front().t + latency;
    Observations until_told;
    std::ranges::copy_if(sequence.observations, std::back_inserter(until_told),
                         [&](const auto& z) { return z.t <= told; });
    CHECK_FALSE(estimate(name, sequence, until_told, told).online.empty());
  });
}

TEST_CASE("Every back-end gives the same bits for the same observations") {
  const Sequence sequence;
  for_each_backend([&](const std::string& name) {
    const Estimate a = estimate(name, sequence, sequence.observations);
    const Estimate b = estimate(name, sequence, sequence.observations);
    REQUIRE(a.trajectory.size() == b.trajectory.size());
    for (std::size_t i = 0; i < a.trajectory.size(); ++i) {
      REQUIRE(a.trajectory.poses()[i].T.p == b.trajectory.poses()[i].T.p);
      REQUIRE(a.trajectory.poses()[i].T.q.coeffs() == b.trajectory.poses()[i].T.q.coeffs());
    }
    REQUIRE(a.map.size() == b.map.size());
    for (std::size_t i = 0; i < a.map.size(); ++i) REQUIRE(a.map[i].position == b.map[i].position);
    CHECK(a.online.size() == b.online.size());
  });
}
