#include "bench/run_folder.hpp"

#include <filesystem>
#include <map>

#include "bench/scores_by_protocol.hpp"
#include "bench/testing/keys.hpp"
#include "bench/testing/program.hpp"
#include "core/data/tum.hpp"
#include "core/io/sha256.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "eval/find_runs.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

const std::set<std::string> kFiles = {"config.json",  "job.json",         "manifest.json",   "final.tum",
                                      "causal.tum",   "causal_poses.txt", "groundtruth.tum", "map.ply",
                                      "metrics.json", "timing.csv",       "log.txt",         "status.json"};

/// The runs of a config by label.
std::map<std::string, std::string> run_folders(const TemporaryFolder& folder, const std::string& out) {
  std::map<std::string, std::string> folders;
  for (const auto& experiment : std::filesystem::directory_iterator(folder.file(out))) {
    for (const std::string& run : runs_of(experiment.path().string())) {
      folders[parse_json(read_file(run + "/metrics.json")).at("label").get<std::string>()] = run;
    }
  }
  return folders;
}

Json json_file(const std::string& folder, const std::string& name) {
  return parse_json(read_file(folder + "/" + name));
}

/// Every path to a value, "ate.trans_m.rmse".
void collect_keys(const Json& json, const std::string& prefix, std::set<std::string>& keys) {
  if (!json.is_object()) {
    keys.insert(prefix);
    return;
  }
  for (const auto& [key, value] : json.items()) collect_keys(value, prefix + "/" + key, keys);
}

std::set<std::string> keys_of(const Json& json) {
  std::set<std::string> keys;
  collect_keys(json, "", keys);
  return keys;
}

/// The short comparison, run twice; once for all tests.
struct TwoRuns {
  TemporaryFolder folder;
  std::map<std::string, std::string> first, second;

  TwoRuns() {
    folder.write("c.json", dump_json(short_comparison()));
    REQUIRE(testing::evbench(folder, "run c.json --out first --quiet").exit_code == 0);
    REQUIRE(testing::evbench(folder, "run c.json --out second --quiet").exit_code == 0);
    first = run_folders(folder, "first");
    second = run_folders(folder, "second");
  }
};

const TwoRuns& two_runs() {
  static const TwoRuns runs;
  return runs;
}

}  // namespace

TEST_CASE("A run's folder holds the documented files", "[slow]") {
  const TwoRuns& runs = two_runs();
  REQUIRE(runs.first.size() == 2);
  for (const auto& [label, path] : runs.first) {
    std::set<std::string> files = kFiles;
    if (label == "asynchronous") {
      files.insert({"covariance.txt", "estimated_parameters.csv", "velocities.txt"});  // only gp_map has them
    }
    CHECK(names_in(path) == files);
    CHECK(json_file(path, "status.json").at("state").is_string());
    const Json manifest = json_file(path, "manifest.json");
    for (const char* key : {"program", "host", "seed", "key", "config_sha256", "inputs_sha256", "observations"}) {
      CHECK(manifest.contains(key));
    }
    CHECK_THAT(read_file(path + "/timing.csv"), ContainsSubstring("t_s,update_ms,"));
    CHECK_THAT(read_file(path + "/log.txt"), ContainsSubstring(label) && ContainsSubstring("tracks simulated"));
  }
  CHECK(runs_of(runs.folder.file("first/short")).size() == 2);
}

TEST_CASE("The same config twice gives identical files, except measured times", "[slow]") {
  const TwoRuns& runs = two_runs();
  for (const auto& [label, path] : runs.first) {
    INFO(label);
    const std::string& other = runs.second.at(label);
    CHECK(std::filesystem::path(path).filename() == std::filesystem::path(other).filename());
    for (const char* name : {"config.json", "job.json", "final.tum", "causal.tum", "causal_poses.txt",
                             "groundtruth.tum", "map.ply", "status.json"}) {
      CHECK(read_file(path + "/" + name) == read_file(other + "/" + name));
    }
    Json manifest = json_file(path, "manifest.json"), other_manifest = json_file(other, "manifest.json");
    for (Json* one : {&manifest, &other_manifest}) CHECK(one->erase("finished") == 1);
    CHECK(dump_json(manifest) == dump_json(other_manifest));
    const Json a = json_file(path, "metrics.json"), b = json_file(other, "metrics.json");
    CHECK(a.at("final").at("ate").at("trans_m").at("rmse").is_number());
    CHECK(dump_json(a.at("final")) == dump_json(b.at("final")));
    CHECK(dump_json(a.at("causal")) == dump_json(b.at("causal")));
  }
}

TEST_CASE("A run is scored at zero latency and at equal latency, and by its covariances", "[slow]") {
  const TwoRuns& runs = two_runs();
  for (const auto& [label, path] : runs.first) {
    INFO(label);
    const Json metrics = json_file(path, "metrics.json"), causal = metrics.at("causal");
    const auto ate = [](const Json& scores) { return scores.at("ate").at("trans_m").at("rmse").get<double>(); };
    CHECK(causal.at("zero_latency").at("latency_s") == 0.0);
    CHECK(causal.at("equal_latency").at("latency_s") == 0.2);
    CHECK(ate(causal.at("equal_latency")) < ate(causal.at("zero_latency")));
    CHECK(causal.at("zero_latency").at("pairs") > 300);  // of ground truth at 200 Hz
    CHECK(metrics.at("covariance").is_null() == (label != "asynchronous"));
  }
  const Json covariance = json_file(runs.first.at("asynchronous"), "metrics.json").at("covariance");
  for (const char* kind : {"newest", "over_100ms", "over_1s"}) {
    INFO(kind);
    CHECK(covariance.at(kind).at("n") > 10);
    CHECK(covariance.at(kind).at("singular") == 0);
    CHECK(covariance.at(kind).at("nees") > 0.1);
    CHECK(covariance.at(kind).at("nees") < 10.0);
    CHECK(covariance.at(kind).at("within_3_sigma") > 0.8);
  }
  const std::string folder = "'" + runs.folder.file("first") + "'";
  const Outcome table = testing::evbench(runs.folder, "table --causal " + folder);
  CHECK_THAT(table.out, ContainsSubstring("ATE at zero latency [m]") && ContainsSubstring("ATE at equal latency [m]") &&
                            ContainsSubstring("equal latency 0.2 s"));
  CHECK_THAT(testing::evbench(runs.folder, "table --metrics covariance.over_1s.nees,covariance.newest.within_2_sigma," +
                                               std::string("causal.zero_latency.ate.trans_m.rmse ") + folder)
                 .out,
             ContainsSubstring("NEES over 1 s") && ContainsSubstring("covariance.newest.within_2_sigma") &&
                 ContainsSubstring("causal ATE at zero latency [m]"));
}

TEST_CASE("A table also scores its runs over their common time", "[slow]") {
  const TwoRuns& runs = two_runs();
  const std::string folder = "'" + runs.folder.file("first") + "'";
  const Outcome table = testing::evbench(
      runs.folder, "table --format csv --metrics common.span_s,common.coverage,common.ate.trans_m.rmse " + folder);
  CHECK(table.exit_code == 2);  // a span is not a number
  const Outcome text = testing::evbench(runs.folder, "table " + folder);
  CHECK_THAT(text.out, ContainsSubstring("ATE, common time [m]") && ContainsSubstring("Common time: ") &&
                           ContainsSubstring("covered by all runs that were not lost"));
  std::vector<RunRecord> records = find_runs(std::vector{runs.folder.file("first")});
  score_common_time(records, false);
  const auto span = [](const Json& scores) {
    return std::pair(scores.at("span_s")[0].get<double>(), scores.at("span_s")[1].get<double>());
  };
  REQUIRE(records.size() == 2);
  const auto a = span(records[0].final_scores), b = span(records[1].final_scores);
  for (const RunRecord& record : records) {
    const auto common = span(record.common_scores);
    CHECK(common.first >= std::max(a.first, b.first));
    CHECK(common.first < std::max(a.first, b.first) + 0.05);
    CHECK(common.second <= std::min(a.second, b.second));
    CHECK(record.common_scores.at("coverage") > 0.99);
  }
  score_common_time(records, true);
  const double begin = std::max(span(records[0].causal_scores).first, span(records[1].causal_scores).first);
  for (const RunRecord& record : records) {
    const Json& at_latency = record.common_scores.at("equal_latency");
    CHECK(at_latency.at("latency_s") == 0.2);
    CHECK(at_latency.at("pairs") < record.causal_scores.at("equal_latency").at("pairs"));
    CHECK(span(at_latency).first >= begin);
  }
  records[0].folder = "/nowhere";
  score_common_time(records, false);
  CHECK(records[0].common_scores.is_null());
}

TEST_CASE("All back-ends of a comparison get the identical observations", "[slow]") {
  const TwoRuns& runs = two_runs();
  CHECK(json_file(runs.first.at("asynchronous"), "manifest.json").at("tracks_sha256") ==
        json_file(runs.first.at("frames of 50 ms"), "manifest.json").at("tracks_sha256"));
}

TEST_CASE("The config in a run's folder gives the same run again, from any folder", "[slow]") {
  const std::string& path = two_runs().first.at("frames of 50 ms");
  const TemporaryFolder folder;
  REQUIRE(testing::evbench(folder, "run '" + path + "/config.json' --out again --quiet").exit_code == 0);
  const std::string again = run_folders(folder, "again").at("frames of 50 ms");
  CHECK(std::filesystem::path(again).filename() == std::filesystem::path(path).filename());
  CHECK(read_file(again + "/final.tum") == read_file(path + "/final.tum"));
  CHECK(read_file(again + "/config.json") == read_file(path + "/config.json"));
}

TEST_CASE("Metrics of a run have the documented keys, the same as those of evbench eval", "[slow]") {
  const TwoRuns& runs = two_runs();
  const std::string& path = runs.first.at("asynchronous");
  const Json metrics = json_file(path, "metrics.json");
  for (const char* key : {"experiment", "label", "runtime_s", "realtime_factor", "peak_rss_mib", "status"}) {
    CHECK(metrics.contains(key));
  }
  CHECK(metrics.at("seed") == 1);
  CHECK(metrics.at("key") == std::filesystem::path(path).filename().string());
  for (const char* part : {"frontend_s", "backend_s", "waiting_s", "harness_s", "total_s"}) {
    CHECK(metrics.at("times").at(part).is_number());
  }
  for (const char* steps : {"frontend_ms", "backend_ms"}) {  // of each batch, of each update
    const Json times = metrics.at("times").at(steps);
    CHECK(times.at("median") <= times.at("p99"));
    CHECK(times.at("p99") <= times.at("max"));
    CHECK(times.at("max") > 0.0);
  }
  CHECK(metrics.at("status") == json_file(path, "status.json"));
  REQUIRE(metrics.at("events").size() >= 3);
  const Json& first = metrics.at("events").front();
  CHECK(first.at("kind") == "initialised");
  CHECK(first.at("t").get<double>() > 0.0);
  CHECK_THAT(read_file(path + "/log.txt"), ContainsSubstring(first.at("text").get<std::string>()));
  CHECK(metrics.at("counters").at("initial_maps") == 1);
  CHECK(metrics.at("counters").at("landmarks").get<int>() > 10);
  for (const char* trajectory : {"final", "causal"}) {
    for (const char* key : {"/ate/trans_m/rmse", "/ate/rot_deg/rmse", "/ate/trans_percent", "/rpe/trans_m/rmse",
                            "/rpe/rot_deg/median", "/rpe/pairs", "/coverage", "/pairs", "/scale", "/path_m"}) {
      INFO(trajectory << key);
      CHECK(metrics.at(trajectory).at(Json::json_pointer(key)).is_number());
    }
  }
  const std::string files = "'" + path + "/final.tum' '" + path + "/causal.tum'";
  REQUIRE(testing::evbench(runs.folder, "eval " + files + " --json eval.json -as").exit_code == 0);
  const Json eval = parse_json(read_file(runs.folder.file("eval.json")));
  CHECK(keys_of(eval.at("final")) == keys_of(metrics.at("final")));
  for (const auto& [key, value] : metrics.items()) CHECK(eval.contains(key));
}

TEST_CASE("A run writes its final problem in the format that evbench solve reads", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_config("gp_map")));
  REQUIRE(testing::evbench(folder, "run c.json --out out --problem --quiet").exit_code == 0);
  const std::string run = run_folders(folder, "out").at("gp_map");
  const Outcome solved = testing::evbench(folder, "solve '" + run + "/problem.txt' --mode batch --json s.json");
  REQUIRE(solved.exit_code == 0);
  const Json report = json_file(folder.path(), "s.json");
  CHECK(report.at("cost").get<double>() > 0.0);
  CHECK(report.at("cost_motion_prior").get<double>() > 0.0);
}

TEST_CASE("Relative paths of a config refer to its folder, and inputs are hashed into the manifest", "[slow]") {
  const TemporaryFolder folder;
  const TemporaryFolder elsewhere;
  write_recording(folder);
  const Outcome run = testing::evbench(elsewhere, "run '" + folder.file("recording.json") + "' --quiet");
  CHECK(run.exit_code <= 3);  // fixed points give no map
  CHECK(run.err.empty());
  const auto folders = run_folders(elsewhere, "results");
  REQUIRE(folders.size() == 1);
  const Json inputs = json_file(folders.begin()->second, "manifest.json").at("inputs_sha256");
  CHECK(inputs.size() == 3);
  CHECK(inputs.at(folder.file("tracks.txt")) == sha256_file(folder.file("tracks.txt")));
  CHECK(testing::evbench(elsewhere, "run '" + folders.begin()->second + "/config.json' --check").exit_code == 0);
  CHECK(testing::evbench(elsewhere, "run '" + folders.begin()->second + "/config.json' --quiet").err.empty());
}

TEST_CASE("A run without an estimate fails with exit code 3, a status with the reason, and all files") {
  const TemporaryFolder folder;
  write_recording(folder);
  REQUIRE(testing::evbench(folder, "run recording.json --quiet").exit_code == 3);
  const auto folders = run_folders(folder, "results");
  REQUIRE(folders.size() == 1);
  CHECK(names_in(folders.begin()->second) == kFiles);
  const Json status = json_file(folders.begin()->second, "status.json");
  CHECK(status.at("state") == "failed");
  CHECK_FALSE(status.at("reason").get<std::string>().empty());
  CHECK(json_file(folders.begin()->second, "metrics.json").at("final").is_null());
}

TEST_CASE("The longest trajectory segment is scored, and the others are written next to it") {
  const TemporaryFolder folder;
  const std::string path = folder.write("c.json", dump_json(short_config()));
  const RunConfig config = read_experiment(path, {}, known_plugins()).runs[0];
  const auto source = make_source(config.job, known_plugins());
  Execution execution;
  for (const auto& [from, to] : {std::pair{0.1, 0.6}, {0.7, 2.9}, {2.95, 3.0}}) {
    TrajectorySegment segment;
    segment.final_trajectory = source->ground_truth().cut(from, to);
    segment.causal_trajectory = source->ground_truth().cut(from + 0.01, to);
    segment.map.resize(3);
    execution.result.segments.push_back(segment);
  }
  execution.result.longest = 1;
  execution.result.status = {RunState::lost, "no observations", 0.6, {}};
  RunRecord record;
  {
    RunFolder run(folder.file("out"), "short", "mine");
    record = run.write(config, identity_of(config), *source, ground_truth_tum(*source), execution);
  }
  std::set<std::string> expected = kFiles;
  for (const char* name :
       {"final.segment1.tum", "causal.segment1.tum", "causal_poses.segment1.txt", "map.segment1.ply",
        "final.segment3.tum", "causal.segment3.tum", "causal_poses.segment3.txt", "map.segment3.ply"}) {
    expected.insert(name);
  }
  const std::string made = folder.file("out/short/mine");
  CHECK(names_in(made) == expected);
  const PoseTrajectory scored = read_tum(made + "/final.tum"), first = read_tum(made + "/final.segment1.tum");
  CHECK(scored.start() == Approx(0.7).margin(0.01));
  CHECK(first.end() == Approx(0.6).margin(0.01));
  const Json status = json_file(made, "status.json");
  CHECK(status.at("scored_segment") == 2);
  REQUIRE(status.at("segments").size() == 3);
  CHECK(status.at("segments")[1].at("poses") == scored.size());
  CHECK(status.at("segments")[1].at("landmarks") == 3);
  CHECK(status.at("segments")[0].at("to") == first.end());
  const Json metrics = json_file(made, "metrics.json");
  CHECK(metrics.at("final").at("pairs") == scored.size());
  CHECK(metrics.at("final").at("ate").at("trans_m").at("rmse").get<double>() < 1e-6);
  CHECK(to_json(record) == metrics);
  const std::string before = read_file(made + "/metrics.json");
  score_again(made, config.evaluation);
  CHECK(read_file(made + "/metrics.json") == before);
  CHECK(names_in(made) == expected);
}

TEST_CASE("Two runs do not write to the same folder at the same time", "[slow]") {
  const TemporaryFolder folder;
  const std::string path = folder.write("c.json", dump_json(short_config()));
  const std::string key = key_of(read_experiment(path, {}, known_plugins()).runs[0]);
  {
    const RunFolder taken(folder.file("results"), "short", key);
    CHECK_THROWS_WITH(RunFolder(folder.file("results"), "short", key),
                      ContainsSubstring("another run is writing to this folder"));
    const Outcome other = testing::evbench(folder, "run c.json");
    CHECK(other.exit_code == 2);
    CHECK_THAT(other.err, ContainsSubstring(key) && ContainsSubstring("another run is writing to this folder"));
    CHECK(testing::evbench(folder, "run c.json --out elsewhere --quiet").exit_code == 0);
  }
  CHECK(names_in(folder.file("results/short")).empty());
  CHECK(testing::evbench(folder, "run c.json --quiet").exit_code == 0);
  CHECK(names_in(folder.file("results/short")) == std::set<std::string>{key, "index.csv"});
}

TEST_CASE("Of many processes that run the same config at once, each succeeds or is refused, and the result is whole",
          "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_config()));
  const Outcome all = testing::shell(folder, R"(
    for i in 1 2 3 4; do ("$evbench" run c.json --quiet; echo $?) & done; wait)");
  int done = 0;
  for (const char c : all.out) {
    CHECK((c == '0' || c == '2' || c == '\n'));
    done += c == '0' ? 1 : 0;
  }
  CHECK(done >= 1);
  CHECK(runs_of(folder.file("results/short")).size() == 1);
  CHECK(names_in(run_folders(folder, "results").at("bundle_adjustment")) == kFiles);
}
