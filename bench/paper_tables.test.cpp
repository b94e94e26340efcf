#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "bench/testing/program.hpp"
#include "core/support/json.hpp"
#include "core/support/median.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;

namespace {

const std::string kConfigs = EVBENCH_CONFIGS;

/// metrics.json of each run of an experiment by label.
std::map<std::string, Json> metrics_of(const std::string& experiment) {
  std::map<std::string, Json> metrics;
  for (const std::string& run : runs_of(experiment)) {
    const Json json = parse_json(read_file(run + "/metrics.json"));
    metrics[json.at("label").get<std::string>()] = json;
  }
  return metrics;
}

double ate(const Json& metrics) { return metrics.at("final").at("ate").at("trans_m").at("rmse").get<double>(); }

}  // namespace

TEST_CASE("Table I on real tracks: errors are at most a tenth larger than the recorded ones", "[slow]") {
  if (!data_file("poster_translation/tracks_eklt.txt")) return;
  const TemporaryFolder folder;
  REQUIRE(testing::evbench(folder, "run '" + kConfigs + "/paper/table1_poster_translation.json' --quiet").exit_code ==
          0);
  const auto metrics = metrics_of(folder.file("results/table1_poster_translation"));
  REQUIRE(metrics.size() == 8);
  const Json& asynchronous = metrics.at("asynchronous");
  CHECK(ate(asynchronous) < 0.0046);
  CHECK(asynchronous.at("final").at("rpe").at("trans_m").at("rmse").get<double>() < 0.0025);
  CHECK(asynchronous.at("final").at("coverage").get<double>() > 0.97);
  CHECK(ate(metrics.at("bundle adjustment, 50 ms")) < 0.0065);
  CHECK(ate(metrics.at("bundle adjustment, 100 ms")) < 0.0058);
}

TEST_CASE("HASTE's tracks of hand-held motion, with gp_map's defaults", "[long]") {
  for (const auto& [sequence, most] : {std::pair{"dynamic_plane", 0.18}, {"dynamic_boxes", 0.18}}) {
    if (!data_file("haste_simulated/" + std::string(sequence) + "/tracks.txt")) return;
    const TemporaryFolder folder;
    const std::string only = " --only 'back-end=asynchronous' --only sequence=" + std::string(sequence);
    REQUIRE(testing::evbench(folder, "sweep '" + kConfigs + "/sweeps/recorded_tracks.json' --quiet --out s" + only +
                                         " --only frontend.sigma=1.0")
                .exit_code == 0);
    const Json metrics = metrics_of(folder.file("s/recorded_tracks")).at("asynchronous");
    INFO(sequence);
    CHECK(metrics.at("status").at("state") == "ok");
    CHECK(metrics.at("final").at("ate").at("trans_percent").get<double>() < most);
  }
}

TEST_CASE("Tracks of aggressive motion: the final estimate does not reject correct tracks", "[long]") {
  const auto tracks = data_file("haste_simulated/poster_violent/tracks.txt");
  if (!tracks) return;
  const TemporaryFolder folder;
  const Json config{
      {"name", "aggressive"},
      {"source",
       {{"type", "recording"},
        {"folder", std::filesystem::path(*tracks).parent_path().string()},
        {"width", 240},
        {"height", 180}}},
      {"frontend", {{"type", "recorded"}, {"tracks", *tracks}, {"sigma", 0.5}}},
      {"backend", {{"type", "gp_map"}, {"label", "asynchronous"}}},
      {"evaluation",
       {{"alignment", "sim3"}, {"association", "interpolated"}, {"rpe_delta", 0.1}, {"rpe_unit", "seconds"}}}};
  folder.write("aggressive.json", dump_json(config));
  REQUIRE(testing::evbench(folder, "run aggressive.json --quiet").exit_code == 0);
  const Json final_scores = metrics_of(folder.file("results/aggressive")).at("asynchronous").at("final");
  CHECK(final_scores.at("ate").at("trans_percent").get<double>() < 1.0);
  CHECK(final_scores.at("rpe").at("trans_m").at("rmse").get<double>() < 0.03);
}

TEST_CASE("When real tracks end, the trajectory ends with them, and the run is degraded or lost", "[slow]") {
  if (!data_file("poster_translation/tracks_eklt.txt")) return;
  const TemporaryFolder folder;
  const std::string run = "run '" + kConfigs + "/paper/table1_poster_translation.json' --quiet";
  REQUIRE(testing::evbench(folder, run + " --set 'source.time_range=[0,5.3]'").exit_code == 0);
  for (const auto& [label, metrics] : metrics_of(folder.file("results/table1_poster_translation"))) {
    INFO(label);
    const std::string state = metrics.at("status").at("state").get<std::string>();
    CHECK((state == "degraded" || state == "lost"));
    CHECK(metrics.at("final").at("coverage").get<double>() > 0.55);
  }
}

TEST_CASE("gp_map stays below one percent of the path over 30 s with a tenth of the tracks wrong", "[long]") {
  const TemporaryFolder folder;
  Json config = short_config("gp_map");
  config["source"] = {{"type", "simulation"},
                      {"duration", 30},
                      {"motion", {{"kind", "smooth_random"}}},
                      {"scene", {{"kind", "frustum"}}},
                      {"tracks", {{"lifetime", {1, 4}}, {"noise", 0.7}, {"outlier_share", 0.1}}}};
  folder.write("c.json", dump_json(config));
  for (const std::string seed : {"4", "8"}) {  // initialisation may exchange near and far with these
    INFO(seed);
    REQUIRE(testing::evbench(folder, "run c.json --quiet --set seed=" + seed + " --out s" + seed).exit_code == 0);
    const Json metrics = metrics_of(folder.file("s" + seed) + "/short").at("gp_map");
    CHECK(metrics.at("final").at("ate").at("trans_percent").get<double>() < 1.0);
    CHECK(metrics.at("final").at("coverage").get<double>() > 0.97);
  }
}

TEST_CASE("Landmarks of unknown depth after a slow beginning do not let the scale collapse", "[slow]") {
  if (!data_file("dynamic_6dof/motion.txt")) return;
  const TemporaryFolder folder;
  Json config = short_config("gp_map");
  config["seed"] = 4;  // a scale from the mean logarithm of distances is lost after 3 s
  config["source"] = {
      {"type", "simulation"},
      {"duration", 7},
      {"camera", {{"width", 240}, {"height", 180}, {"focal_length", 200}}},
      {"motion", {{"kind", "trajectory"}, {"trajectory", "${EVBENCH_DATA}/dynamic_6dof/motion.txt"}, {"start", 0}}},
      {"scene", {{"kind", "frustum"}}},
      {"tracks", {{"outlier_share", 0.05}, {"drift_share", 0.05}, {"dropout_rate", 0.1}}}};
  folder.write("c.json", dump_json(config));
  REQUIRE(testing::evbench(folder, "run c.json --quiet").exit_code == 0);
  const Json metrics = metrics_of(folder.file("results/short")).at("gp_map");
  CHECK(metrics.at("status").at("state") == "ok");
  CHECK(metrics.at("final").at("ate").at("trans_percent").get<double>() < 1.0);
}

namespace {

/// Hand-held motion in front of a wall, with outliers and drifting tracks; returns ATE [% of path] by seed.
std::vector<double> hand_held(double start, double duration, const std::vector<std::string>& seeds) {
  const TemporaryFolder folder;
  Json config = short_config("gp_map");
  config["source"] = {
      {"type", "simulation"},
      {"duration", duration},
      {"camera", {{"width", 240}, {"height", 180}, {"focal_length", 200}}},
      {"motion", {{"kind", "trajectory"}, {"trajectory", "${EVBENCH_DATA}/dynamic_6dof/motion.txt"}, {"start", start}}},
      {"scene", {{"kind", "plane"}, {"near", 1.2}, {"far", 2.5}}},
      {"tracks",
       {{"alive", 50}, {"lifetime", {0.3, 2}}, {"noise", 0.5}, {"outlier_share", 0.05}, {"drift_share", 0.05}}}};
  folder.write("c.json", dump_json(config));
  std::vector<double> percent;
  for (const std::string& seed : seeds) {
    INFO(seed);
    REQUIRE(testing::evbench(folder, "run c.json --quiet --set seed=" + seed + " --out s" + seed).exit_code == 0);
    const Json metrics = metrics_of(folder.file("s" + seed) + "/short").at("gp_map");
    CHECK(metrics.at("final").at("coverage").get<double>() > 0.95);
    percent.push_back(metrics.at("final").at("ate").at("trans_percent").get<double>());
  }
  return percent;
}

}  // namespace

TEST_CASE("Outliers that are triangulated close to the camera do not dominate its motion", "[long]") {
  if (!data_file("dynamic_6dof/motion.txt")) return;
  // Median over seeds; with unbounded leverage 0.68.
  CHECK(median(hand_held(0.0, 20.0, {"8", "9", "10", "11", "12"})) < 0.4);
}

TEST_CASE("The scale is recovered where most of the view is replaced within a second", "[long]") {
  if (!data_file("dynamic_6dof/motion.txt")) return;
  // Without an alternative hypothesis for recent landmarks, 1.7 to 5.1 each.
  const std::vector<double> percent = hand_held(15.0, 15.0, {"502", "505", "506", "509", "510", "512"});
  CHECK(std::ranges::count_if(percent, [](double p) { return p > 1.0; }) <= 1);
}
