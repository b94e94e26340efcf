#include "backends/gp_map/modules/map_validation.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "backends/gp_map/testing/tracked_scene.hpp"
#include "core/support/median.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {
namespace {

using testing::run;
using testing::TrackedScene;

constexpr const char* kPoorTracks = R"({"tracks": {"alive": 40, "lifetime": [0.3, 0.6], "noise": 2.5}})";

}  // namespace

TEST_CASE("Halves of the map are as far from the whole as the whole is from the truth", "[long]") {
  std::vector<double> ratios;
  for (std::uint64_t seed = 1; seed <= 9; ++seed) {
    const TrackedScene scene(4.0, R"({"tracks": {"alive": 40, "lifetime": [0.3, 1.0], "noise": 1.0}})", seed);
    const auto result = run(scene);
    const auto difference = difference_of_halves(result.backend->graph(), {});
    REQUIRE(difference);
    ratios.push_back(100.0 * *difference / result.scores.ate.trans_percent);
  }
  CAPTURE(ratios);
  CHECK(median(ratios) > 0.5);
  CHECK(median(ratios) < 2.0);
}

TEST_CASE("A run whose halves differ by too much is degraded and says so, others are ok", "[slow]") {
  const auto good = run(TrackedScene(3.0));
  CHECK(good.backend->status().state == RunState::ok);
  const TrackedScene scene(4.0, kPoorTracks, 2);
  const auto poor = run(scene);
  const Status doubted = poor.backend->status();
  CHECK(doubted.state == RunState::degraded);
  CHECK_THAT(doubted.reason, Catch::Matchers::ContainsSubstring("two halves of the map disagree by"));
  REQUIRE(doubted.degraded.size() == 1);
  CHECK(doubted.degraded.front().from == poor.backend->trajectory().start());
  CHECK(doubted.degraded.front().to == Approx(4.0).margin(0.01));
  CHECK(run(scene, {.backend = R"({"validation": {"enabled": false}})"}).backend->status().state == RunState::ok);
}

TEST_CASE("Few landmarks have no halves") {
  FactorGraph graph;
  CHECK_FALSE(difference_of_halves(graph, {}));
}

}  // namespace evbench::gp_map
