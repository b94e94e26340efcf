#include <set>
#include <string>
#include <vector>

#include "bench/testing/program.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;

TEST_CASE("From a start in a deceleration, with little translation, the final estimate is right", "[long]") {
  const auto motion = data_file("dynamic_6dof/motion.txt");
  if (!motion) return;
  struct Start {
    const char* scene;
    int seed;
    Json options;  ///< of the back-end, in addition to its defaults
  };
  const Json usual = Json::object();
  const std::vector<Start> starts{{"plane", 52, usual},
                                  {"plane", 53, usual},
                                  {"boxes", 52, usual},
                                  {"boxes", 53, usual},
                                  {"plane", 52, {{"per_observation", true}}},
                                  {"boxes", 53, {{"per_observation", true}}},
                                  {"plane", 52, {{"lag", 1}}},
                                  {"boxes", 53, {{"lag", 1}}}};
  for (const auto& [scene, seed, options] : starts) {
    CAPTURE(scene, seed, dump_json(options));
    Json config{{"name", "start"},
                {"seed", seed},
                {"source",
                 {{"type", "event_simulation"},
                  {"duration", 2},
                  {"motion", {{"kind", "trajectory"}, {"trajectory", *motion}, {"start", 4}}},
                  {"scene", {{"kind", scene}}},
                  {"simulator", {{"sensor", {{"threshold_on", 0.3}, {"threshold_off", 0.3}}}}}}},
                {"frontend", {{"type", "haste"}}},
                {"backend", {{"type", "gp_map"}}},
                {"evaluation", {{"alignment", "sim3"}, {"association", "interpolated"}}}};
    config["backend"].update(options);
    const TemporaryFolder folder;
    folder.write("start.json", dump_json(config));
    REQUIRE(testing::evbench(folder, "run start.json --quiet").exit_code == 0);
    const std::set<std::string> runs = runs_of(folder.file("results/start"));
    REQUIRE(runs.size() == 1);
    const std::string& run = *runs.begin();
    const Json metrics = parse_json(read_file(run + "/metrics.json"));
    CHECK(metrics.at("status").at("state") == "ok");
    CHECK(metrics.at("final").at("ate").at("trans_percent").get<double>() < 3.0);
  }
}
