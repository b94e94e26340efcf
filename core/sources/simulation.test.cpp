#include "core/sources/simulation.hpp"

#include <map>

#include "core/data/tracks.hpp"
#include "core/data/tum.hpp"
#include "core/io/atomic_file.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

namespace {

Simulation simulate(const std::string& json, std::uint64_t seed = 1, const std::string& folder = "") {
  return Simulation(read_options<Simulation::Options>(parse_json(json), "config"), {seed, folder});
}

}  // namespace

TEST_CASE("A simulated sequence is registered, and gives its camera, ground truth and tracks") {
  const Plugins plugins = registered_plugins();
  const auto& entry = plugins.of<Source>().find("simulation", "test");
  const auto source = entry.make(parse_json(R"({"duration": 2})"), {7, "", "config.source"});
  CHECK(source->camera().width == 240);
  CHECK(source->time_range().to == 2.0);
  CHECK(source->ground_truth().size() == 401);
  REQUIRE(source->true_tracks());
  CHECK(source->true_tracks()->size() > 1000);
  CHECK(source->remarks().size() == 1);
}

TEST_CASE("The same seed gives the same bytes and another seed gives others") {
  const std::string config = R"({"duration": 3, "tracks": {"outlier_share": 0.1, "dropout_rate": 0.5}})";
  const Simulation a = simulate(config, 5), b = simulate(config, 5), c = simulate(config, 6);
  CHECK(format_tracks(*a.true_tracks()) == format_tracks(*b.true_tracks()));
  CHECK(format_tum(a.ground_truth()) == format_tum(b.ground_truth()));
  CHECK(format_tracks(*a.true_tracks()) != format_tracks(*c.true_tracks()));
  CHECK(format_tum(a.ground_truth()) != format_tum(c.ground_truth()));
}

TEST_CASE("The source's own seed takes precedence over the run's") {
  const std::string config = R"({"duration": 1, "seed": 3})";
  CHECK(format_tracks(*simulate(config, 1).true_tracks()) == format_tracks(*simulate(config, 2).true_tracks()));
}

TEST_CASE("Options of the tracks do not change the motion") {
  const Simulation a = simulate(R"({"duration": 1})"), b = simulate(R"({"duration": 1, "tracks": {"alive": 20}})");
  CHECK(format_tum(a.ground_truth()) == format_tum(b.ground_truth()));
}

TEST_CASE("A simulation follows a trajectory file and names it among its files") {
  const testing::TemporaryFolder folder;
  const Simulation straight = simulate(R"({"duration": 5})");
  write_file(folder.file("path.txt"), format_tum(straight.ground_truth()));
  const Simulation follower =
      simulate(R"({"duration": 4, "motion": {"kind": "trajectory", "trajectory": "path.txt"}})", 1, folder.path());
  CHECK(follower.files() == std::vector<std::string>{folder.file("path.txt")});
  CHECK((follower.ground_truth().poses()[300].T.p - straight.ground_truth().poses()[300].T.p).norm() < 1e-3);
}

TEST_CASE("A simulation refuses options that contradict one another, and says which") {
  CHECK_THROWS_WITH(simulate(R"({"scene": {"near": 3, "far": 2}})"), ContainsSubstring("near < far"));
  CHECK_THROWS_WITH(simulate(R"({"camera": {"distortion": "equidistant", "coefficients": [0.1]}})"),
                    ContainsSubstring("source.camera.coefficients: has 1"));
  CHECK_THROWS_WITH(simulate(R"({"camera": {"distortion": "radial_tangential", "coefficients": [-5, 0, 0, 0, 0]}})"),
                    ContainsSubstring("invertible"));
  CHECK_THROWS_WITH(simulate(R"({"motion": {"kind": "trajectory"}})"), ContainsSubstring("motion.trajectory"));
  CHECK_THROWS_WITH(simulate(R"({"motion": {"kind": "trajectory", "trajectory": "/no/such"}})"),
                    ContainsSubstring("no such file"));
  CHECK_THROWS_WITH(simulate(R"({"tracks": {"lifetime": [2, 1]}})"), ContainsSubstring("tracks.lifetime"));
  CHECK_THROWS_WITH(simulate(R"({"tracks": {"blackouts": [2, 1]}})"), ContainsSubstring("tracks.blackouts"));
  CHECK_THROWS_WITH(simulate(R"({"motion": {"hold": [1]}})"), ContainsSubstring("motion.hold"));
  CHECK_THROWS_WITH(simulate(R"({"tracks": {"outlier_share": 0.7, "drift_share": 0.7}})"),
                    ContainsSubstring("at most 1"));
  CHECK_THROWS_WITH(simulate(R"({"tracks": {"border": 90}})"), ContainsSubstring("tracks.border"));
  CHECK_THROWS_WITH(simulate(R"({"duration": 1, "tracks": {"blackouts": [-1, 2]}})"),
                    ContainsSubstring("no observation"));
}

TEST_CASE("A trajectory that ends before the sequence is refused") {
  const testing::TemporaryFolder folder;
  folder.write("path.txt", "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n");
  CHECK_THROWS_WITH(
      simulate(R"({"duration": 4, "motion": {"kind": "trajectory", "trajectory": "path.txt"}})", 1, folder.path()),
      ContainsSubstring("lasts 1.000 s"));
  folder.write("path.txt", "20000 0 0 0 0 0 0 1\n30000 0 0 0 0 0 0 1\n40000 0 0 0 0 0 0 1\n");  // microseconds
  CHECK_THROWS_WITH(
      simulate(R"({"duration": 4, "motion": {"kind": "trajectory", "trajectory": "path.txt"}})", 1, folder.path()),
      ContainsSubstring("path.txt has 3 poses from 20000 to 40000 s; expected times in seconds"));
}
