#include "backends/gp_map/gp_map.hpp"

#include <malloc.h>

#include <algorithm>
#include <limits>

#include "backends/gp_map/testing/tracked_scene.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/json.hpp"
#include "core/support/median.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {
namespace {

using testing::run;
using testing::RunOptions;
using testing::TrackedScene;

/// ATE [m] over several seeds of a scene.
double mean_error(const char* scene, const char* backend, double duration = 8.0) {
  constexpr std::uint64_t kSeeds = 4;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    INFO("seed " << seed);
    const auto result = run(TrackedScene(duration, scene, seed), {.backend = backend});
    INFO(result.backend->status().reason);
    REQUIRE(result.backend->status().state == RunState::ok);
    sum += result.scores.ate.trans_m.rmse;
  }
  return sum / kSeeds;
}

}  // namespace

TEST_CASE("gp_map is registered and follows a simulated camera", "[slow]") {
  CHECK(registered_plugins().of<BackEnd>().entries().contains("gp_map"));
  const TrackedScene scene(6.0, R"({"tracks": {"lifetime": [1.0, 3.0]}})");
  const auto result = run(scene);
  CHECK(result.backend->status().state == RunState::ok);
  CHECK(result.scores.ate.trans_percent < 1.0);
  CHECK(result.scores.coverage > 0.97);
  CHECK(result.backend->map().size() > 40);
  CHECK(result.causal.size() > 80);
}

TEST_CASE("With Singer's prior gp_map is as accurate, also with a lag and for each observation", "[slow]") {
  const TrackedScene scene(6.0, R"({"tracks": {"lifetime": [1.0, 3.0]}})");
  const double wnoa = run(scene).scores.ate.trans_percent;
  for (const char* options : {R"({"prior": "singer"})", R"({"prior": "singer", "prior_rate": 1e4})",
                              R"({"prior": "singer", "per_observation": true})", R"({"prior": "singer", "lag": 2})"}) {
    INFO(options);
    const auto result = run(scene, {.backend = options});
    CHECK(result.backend->status().state == RunState::ok);
    CHECK(result.scores.ate.trans_percent < 1.5 * wnoa);
    CHECK(result.scores.coverage > 0.97);
  }
  const double fast = run(scene, {.backend = R"({"prior": "singer", "prior_rate": 1e4})"}).scores.ate.trans_percent;
  CHECK(fast == Approx(wnoa).epsilon(0.2));  // its limit is WNOA
}

TEST_CASE("gp_map drops outlier tracks", "[long]") {
  const TrackedScene scene(6.0, R"({"tracks": {"lifetime": [1.0, 3.0], "outlier_share": 0.1, "drift_share": 0.05}})");
  const auto result = run(scene);
  CHECK(result.backend->status().state == RunState::ok);
  CHECK(result.scores.ate.trans_percent < 1.0);
}

TEST_CASE("A prior that is too strong is relaxed for aggressive motion", "[long]") {
  for (const char* scene : {R"({"motion": {"kind": "smooth_random", "max_frequency": 2.5, "rotation_amplitude": 0.5},
                                "tracks": {"lifetime": [0.3, 1.0]}})",
                            R"({"motion": {"kind": "smooth_random", "max_frequency": 4.0, "rotation_amplitude": 0.2},
                                "tracks": {"lifetime": [0.3, 1.0]}})"}) {
    std::vector<double> errors, ratios;
    for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8}) {
      const TrackedScene tracked(4.0, scene, seed);
      const auto error = [&](const char* options, bool must_be_ok) {
        const auto result = run(tracked, {.backend = options});
        const RunState state = result.backend->status().state;
        const double percent = result.scores.ate.trans_percent;
        INFO("seed " << seed << ", " << options << ": " << result.backend->status().reason << " " << percent);
        if (must_be_ok) CHECK(state == RunState::ok);
        if (state == RunState::ok) CHECK(percent < 0.5);  // what degrades says so
        return percent;
      };
      errors.push_back(error(R"({"qc_scale": 0.1, "relaxation": {"most": 1000}})", seed <= 3));
      ratios.push_back(errors.back() / error("{}", false));
      if (seed == 3) CHECK(median(errors) < 0.3);
    }
    CHECK(median(errors) < 0.2);
    CHECK(median(ratios) < 1.1);  // to the right prior
  }
}

TEST_CASE("Tracks without parallax determine rotation, and a guessed depth improves the estimate", "[long]") {
  // After the initial map the camera only turns: everything that comes into view has unknown depth.
  const char* scene = R"({"motion": {"rotation_only": [2.0, 3.5]}, "tracks": {"lifetime": [0.3, 0.8]}})";
  std::vector<double> patient, guessing;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const TrackedScene turning(6.0, scene, seed);
    for (auto& [errors, options] : {std::pair{&patient, R"({"map": {"patience": 100}})"}, {&guessing, "{}"}}) {
      const auto result = run(turning, {.backend = options});
      INFO("seed " << seed << ": " << result.backend->status().reason << ", " << result.scores.ate.trans_percent
                   << " %");
      CHECK(result.backend->status().state != RunState::failed);
      errors->push_back(result.scores.ate.trans_percent);
      const RunState state = result.backend->status().state;
      if (errors == &guessing) CHECK((state == RunState::ok || (state == RunState::degraded && errors->back() > 1.0)));
    }
  }
  CHECK(median(guessing) < 0.7 * median(patient));
}

TEST_CASE("gp_map's estimate does not depend on how its observations are split into batches", "[slow]") {
  const TrackedScene scene(3.0);
  const auto fine = run(scene, {.chunk = 0.003});
  const auto coarse = run(scene, {.chunk = 0.25});
  const auto a = fine.backend->trajectory().poses();
  const auto b = coarse.backend->trajectory().poses();
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    CHECK(a[i].T.p == b[i].T.p);
    CHECK(a[i].T.q.coeffs() == b[i].T.q.coeffs());
  }
}

TEST_CASE("Tracks of a slow tracker are sufficient for a map", "[long]") {
  for (const char* scene : {R"({"tracks": {"lifetime": [2, 4], "rate": [20, 20]}})",
                            R"({"tracks": {"lifetime": [2, 4], "rate": [10, 12]}})"}) {
    const auto result = run(TrackedScene(6.0, scene));
    INFO(result.backend->status().reason);
    CHECK(result.backend->status().state <= RunState::degraded);
    CHECK(result.scores.ate.trans_percent < 1.0);
    CHECK(result.backend->trajectory().start() < 2.0);
    CHECK(result.backend->trajectory().end() > 5.9);
  }
}

TEST_CASE(
    "A stationary start is in the trajectory, with few states, and no pose is published before a hypothesis search",
    "[long]") {
  constexpr double kStationary = 20.0;  // [s]
  for (const std::uint64_t seed : {1, 2, 3}) {
    const TrackedScene scene(kStationary + 4.0, R"({"motion": {"hold": [0, 20]}, "tracks": {"lifetime": [60, 60]}})",
                             seed);
    const auto result = run(scene);
    CHECK(result.backend->status().state == RunState::ok);
    CHECK(result.scores.ate.trans_percent < 1.0);
    const auto& states = result.backend->graph().states;
    CHECK(states.front().t < 1.0);
    const auto stationary =
        std::ranges::count_if(states, [&](const ControlState& state) { return state.t < kStationary; });
    CHECK(stationary < 100);
    CHECK(result.causal.start() > kStationary + 0.7);  // a fixed delay after the map would give 0.6 at most
  }
}

TEST_CASE("A short blackout is carried by the prior and reported", "[slow]") {
  const TrackedScene scene(6.0, R"({"tracks": {"lifetime": [1.0, 3.0], "blackouts": [3.0, 3.3]}})");
  const auto result = run(scene);
  const Status status = result.backend->status();
  CHECK(status.state == RunState::degraded);
  REQUIRE_FALSE(status.degraded.empty());
  CHECK(status.degraded.front().from == Approx(3.0).margin(0.1));
  CHECK(status.degraded.front().to < 4.0);
  CHECK(result.scores.ate.trans_percent < 10.0);  // the prior alone carries scale and heading across
  CHECK(result.backend->trajectory().end() > 5.9);
}

TEST_CASE("A long blackout ends the run as lost, with the trajectory before it", "[slow]") {
  const TrackedScene scene(7.0, R"({"tracks": {"lifetime": [1.0, 3.0], "blackouts": [3.0, 6.0]}})");
  const auto result = run(scene);
  const Status status = result.backend->status();
  CHECK(status.state == RunState::lost);
  CHECK(status.time == Approx(3.0).margin(0.1));
  CHECK(result.backend->trajectory().end() == Approx(3.0).margin(0.15));
  CHECK(result.scores.ate.trans_percent < 1.5);
}

TEST_CASE("A run with a lag shorter than the patience ends as lost, too") {
  const TrackedScene scene(5.0, R"({"tracks": {"lifetime": [1.0, 3.0], "blackouts": [2.0, 4.5]}})");
  const auto result = run(scene, {.backend = R"({"lag": 0.3})"});
  CHECK(result.backend->status().state == RunState::lost);
  CHECK(result.backend->trajectory().end() < 3.3);
  CHECK(result.backend->trajectory().end() > 2.3);  // marginalised states are not removed
}

TEST_CASE("A stretch of pure rotation does not destroy the trajectory", "[slow]") {
  const TrackedScene scene(7.0, R"({"motion": {"rotation_only": [3.0, 4.5]}, "tracks": {"lifetime": [1.0, 3.0]}})");
  const auto result = run(scene);
  CHECK(result.backend->status().state != RunState::lost);
  CHECK(result.scores.ate.trans_percent < 3.0);
}

TEST_CASE("Slow motion starts as soon as the noise allows, and the trajectory begins with the observations", "[long]") {
  const TrackedScene scene(8.0, R"({"tracks": {"outlier_share": 0.1}})", 5);
  const auto result = run(scene);
  CHECK(result.backend->status().state == RunState::ok);
  CHECK(result.backend->trajectory().start() < scene.observations().front().t + 0.05);
  CHECK(result.scores.ate.trans_percent < 2.0);
}

TEST_CASE("Tracks that end before the initial map extend the trajectory, too", "[slow]") {
  // The camera turns first: none of its first tracks is left when parallax shows.
  const TrackedScene scene(6.0, R"({"motion": {"amplitude": 0.3}, "tracks": {"lifetime": [0.3, 0.6]}})", 2);
  const auto result = run(scene);
  CHECK(result.backend->status().state == RunState::ok);
  CHECK(result.backend->trajectory().start() < 0.1);
}

TEST_CASE("A camera at rest gives no map and reports the reason") {
  const TrackedScene scene(2.0,
                           R"({"motion": {"kind": "smooth_random", "amplitude": 1e-9, "rotation_amplitude": 1e-9}})");
  const auto result = run(scene);
  CHECK(result.backend->status().state == RunState::failed);
  CHECK_THAT(result.backend->status().reason, Catch::Matchers::ContainsSubstring("no initial map"));
  CHECK_THAT(result.backend->status().reason, Catch::Matchers::ContainsSubstring("the tracks have moved by"));
  CHECK(result.backend->trajectory().empty());
}

TEST_CASE("Observations over too short a time for an initial map are reported as such, not as none") {
  for (const double duration : {0.05, 0.13, 0.18}) {
    INFO(duration);
    const auto result = run(TrackedScene(duration));
    CHECK(result.backend->status().state == RunState::failed);
    CHECK_THAT(result.backend->status().reason, Catch::Matchers::ContainsSubstring("no initial map: "));
    CHECK_THAT(result.backend->status().reason,
               Catch::Matchers::ContainsSubstring(duration < 0.1 ? "track" : "needed"));
    CHECK_THAT(result.backend->status().reason, !Catch::Matchers::ContainsSubstring("no observations"));
  }
}

TEST_CASE("Empty data, one track, and two observations do not crash") {
  GpMap empty({}, {});
  empty.advance({{}, {}, 1.0});
  empty.finish();
  CHECK(empty.status().state == RunState::failed);
  CHECK(empty.status().reason == "no initial map: no observations");
  CHECK_FALSE(empty.pose(0.5));

  GpMap one({}, {});
  std::vector<UndistortedObservation> track;
  for (int i = 0; i < 100; ++i) track.push_back({0, 0.01 * i, {100.0 + i, 90.0}, 1.0});
  one.advance({track, {}, 1.0});
  one.finish();
  CHECK(one.status().state == RunState::failed);
  CHECK_THAT(one.status().reason, Catch::Matchers::ContainsSubstring("1 track observed around"));
}

TEST_CASE("Covariance is positive and smallest at the anchor", "[slow]") {
  const TrackedScene scene(2.0);
  const auto result = run(scene);
  const auto start = result.backend->covariance(result.backend->trajectory().start());
  const auto middle = result.backend->covariance(1.03);
  REQUIRE(start);
  REQUIRE(middle);
  CHECK(start->diagonal().head<6>().maxCoeff() < 1e-6);
  CHECK(middle->diagonal().minCoeff() > 0.0);
  CHECK(middle->topLeftCorner<6, 6>().trace() > start->topLeftCorner<6, 6>().trace());
}

TEST_CASE("With each placement rule the error is at most a tenth larger than at 20 Hz", "[long]") {
  const char* robot_arm =
      R"({"motion": {"kind": "robot_arm"}, "tracks": {"lifetime": [0.3, 2.0], "outlier_share": 0.05}})";
  constexpr double kDuration = 5.0;  // [s]
  const double usual = mean_error(robot_arm, R"({"placement": {"rule": "rate", "rate": 20}})", kDuration);
  for (const char* options :
       {"{}", R"({"placement": {"rule": "rate", "rate": 10}})", R"({"placement": {"rule": "rate", "rate": 100}})",
        R"({"placement": {"rule": "observations", "observations": 200}})", R"({"placement": {"rule": "motion"}})"}) {
    INFO(options);
    CHECK(mean_error(robot_arm, options, kDuration) < 1.1 * usual);
  }
}

TEST_CASE("A prior that is estimated while running makes causal poses smoother, and older poses more accurate",
          "[long]") {
  double causal[2] = {}, last[2] = {};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const TrackedScene scene(6.0, "{}", seed);
    for (const bool learns : {false, true}) {
      const auto result = run(scene, {.backend = learns ? R"({"final_iterations": 0})"
                                                        : R"({"final_iterations": 0, "learn": {"prior": "never"}})"});
      const Scores scores = score(scene.ground_truth(), result.causal, {.association = "interpolated"});
      causal[learns] += scores.rpe.trans_m.rmse;
      last[learns] += result.scores.ate.trans_m.rmse;
    }
  }
  CHECK(causal[1] < 0.8 * causal[0]);
  CHECK(last[1] < 0.9 * last[0]);
}

TEST_CASE("The parameters estimated by each update are reported, together with the final ones", "[long]") {
  // From four times a robot arm's pace to a quarter of it. The prior's density begins at 1.
  const TrackedScene scene(8.0, R"({"motion": {"kind": "robot_arm", "pace": [4, 0.25]}})");
  for (const std::string options :
       {"{}", R"({"final_iterations": 0})", R"({"lag": 2})", R"({"learn": {"prior": "never"}})"}) {
    INFO(options);
    const auto result = run(scene, {.backend = options.c_str()});
    const std::vector<std::string> names = result.backend->estimated_parameters();
    const auto estimated = [&](const char* name, double t) {
      const auto updates = result.backend->updates();
      const auto update = std::ranges::find_if(updates, [&](const UpdateRecord& u) { return u.t >= t; });
      REQUIRE(update != updates.end());
      REQUIRE(update->estimated.size() == names.size());
      return update->estimated[static_cast<std::size_t>(std::ranges::find(names, name) - names.begin())];
    };
    const bool learns = options.find("never") == std::string::npos;
    for (const double t : {2.0, 5.0, 7.5}) {
      for (const char* name : {"qc_rotation_y", "qc_translation_x", "final_qc_rotation_y", "final_qc_translation_x"}) {
        INFO(name << " at " << t << " s");
        CHECK((estimated(name, t) < 0.7) == learns);
      }
    }
    CHECK((estimated("final_qc_translation_x", 5.0) == estimated("qc_translation_x", 5.0)) == !learns);
    if (options == "{}")
      CHECK(estimated("final_qc_translation_x", 2.0) > 4.0 * estimated("final_qc_translation_x", 7.0));
  }
}

TEST_CASE("With a fixed prior, and without late outliers, a lag of 2 s costs less than a tenth of the accuracy",
          "[long]") {
  const char* scene = R"({"tracks": {"lifetime": [1.0, 4.0]}})";
  CHECK(mean_error(scene, R"({"lag": 2, "learn": {"prior": "never"}})") <
        1.1 * mean_error(scene, R"({"learn": {"prior": "never"}})"));
}

TEST_CASE("With a lag there is no problem to return, but the trajectory includes its beginning", "[slow]") {
  const auto result = run(TrackedScene(5.0), {.backend = R"({"lag": 2})"});
  CHECK(result.backend->trajectory().start() < 1.0);
  CHECK_FALSE(result.backend->problem());
}

#if !defined(EVBENCH_SANITIZED)
TEST_CASE("With a lag, memory grows by the results alone", "[long]") {
  const TrackedScene scene(45.0, R"({"tracks": {"lifetime": [1.0, 4.0], "outlier_share": 0.1}})");
  const auto bytes_per_state = [&](const char* options) {
    BackEndContext context;
    context.camera = scene.camera();
    GpMap backend(read_options<Options>(parse_json(options), "backend"), context);
    TrackPlayer player = scene.player();
    TrackBatch batch;
    double t = 0.0;
    const auto bytes_at = [&](double until) {  // the minimum of the last second: some memory is temporary
      std::size_t least = std::numeric_limits<std::size_t>::max();
      for (; t < until; t += 0.01) {
        player.advance({t}, batch);
        backend.advance(scene.undistorted(batch));
        if (t > until - 1.0) least = std::min(least, mallinfo2().uordblks);
      }
      return static_cast<double>(least);
    };
    const double before = bytes_at(10.0);
    const std::size_t states = backend.graph().states.size();
    return (bytes_at(44.9) - before) / static_cast<double>(backend.graph().states.size() - states);
  };
  CHECK(bytes_per_state("{}") > 20000.0);
  // Poses, update records, landmarks. At a fixed rate and over a long time, because the number of states in the lag
  // varies.
  CHECK(bytes_per_state(R"({"lag": 2, "placement": {"rule": "rate"}})") < 3000.0);
}
#endif

TEST_CASE("Per observation, each one has a causal pose, and the final estimate is as accurate as the usual one",
          "[long]") {
  const char* lifetime = R"({"tracks": {"lifetime": [1.0, 3.0]}})";
  const TrackedScene scene(5.0, lifetime);
  const auto usual = run(scene);
  for (const char* rule : {"rate", "observations", "motion"}) {
    INFO(rule);
    const std::string options = std::string(R"({"per_observation": true, "placement": {"rule": ")") + rule + R"("}})";
    const auto result = run(scene, {.backend = options.c_str()});
    CHECK(result.causal.size() > 20 * usual.causal.size());
    const Scores causal = score(scene.ground_truth(), result.causal, {.association = "interpolated"});
    CHECK(causal.ate.trans_percent < 1.0);
  }
  CHECK(mean_error(lifetime, R"({"per_observation": true})") < 1.1 * mean_error(lifetime, "{}"));
}

}  // namespace evbench::gp_map
