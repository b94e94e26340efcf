#include <filesystem>
#include <map>

#include "bench/testing/program.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// Runs examples/NAME/config.json with the system's Python, which has numpy.
Outcome run_example(const TemporaryFolder& folder, const std::string& name, const std::string& more = "") {
  const std::string config = std::string(EVBENCH_CONFIGS) + "/../examples/" + name + "/config.json";
  return shell(folder, "PATH=/usr/bin:$PATH \"$evbench\" run '" + config + "' --quiet --out results " + more);
}

/// metrics.json of each run, by label, and the run's folder as "folder".
std::map<std::string, Json> metrics(const TemporaryFolder& folder, const std::string& experiment) {
  std::map<std::string, Json> result;
  for (const std::string& path : runs_of(folder.file("results/" + experiment))) {
    Json content = parse_json(read_file(path + "/metrics.json"));
    content["folder"] = path;
    result[content.at("label")] = content;
  }
  return result;
}

double ate_percent(const Json& run) { return run.at("final").at("ate").at("trans_percent").get<double>(); }

}  // namespace

TEST_CASE("The example back-end in Python estimates the motion, with identical results in two threads", "[long]") {
  const TemporaryFolder folder, again;
  const std::string shorter =
      "--set source.duration=5 --set 'backends=[{\"type\": \"process\", \"label\": \"Python\", "
      "\"command\": [\"python3\", \"backend.py\"]}, {\"type\": \"gp_map\", \"label\": \"gp\"}]'";
  const Outcome outcome = run_example(folder, "python_backend", shorter);
  CAPTURE(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  std::map<std::string, Json> runs = metrics(folder, "python_backend");
  REQUIRE(runs.size() == 2);
  WARN("ATE of the example back-end: " << ate_percent(runs["Python"])
                                       << " % of the path; of gp_map: " << ate_percent(runs["gp"]) << " %");
  CHECK(runs["Python"].at("status").at("state") == "ok");
  CHECK(ate_percent(runs["Python"]) < 0.5);

  REQUIRE(run_example(again, "python_backend", shorter + " --set pipeline.mode=concurrent").exit_code == 0);
  std::map<std::string, Json> concurrent = metrics(again, "python_backend");
  for (const char* const file : {"/final.tum", "/causal.tum", "/map.ply"}) {
    CHECK(read_file(runs["Python"].at("folder").get<std::string>() + file) ==
          read_file(concurrent["Python"].at("folder").get<std::string>() + file));
  }
}

TEST_CASE("A back-end in Python of thirty lines runs, with numpy arrays in and out") {
  const TemporaryFolder folder;
  const Outcome outcome = run_example(folder, "python_minimal");
  CAPTURE(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const std::map<std::string, Json> runs = metrics(folder, "python_minimal");
  REQUIRE(runs.size() == 1);
  const Json& run = runs.begin()->second;
  CHECK(run.at("status").at("state") == "ok");
  CHECK(ate_percent(run) < 10.0);
  CHECK(run.at("causal").at("coverage").get<double>() > 0.9);
}

TEST_CASE("The example front-end in Python makes tracks that a back-end can use", "[long]") {
  const TemporaryFolder folder;
  const Outcome outcome = run_example(folder, "python_frontend");
  CAPTURE(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  std::map<std::string, Json> runs = metrics(folder, "python_frontend");
  REQUIRE(runs.size() == 1);
  const Json& run = runs.begin()->second;
  WARN("ATE with the example front-end: " << ate_percent(run) << " % of the path");
  CHECK(run.at("status").at("state") == "ok");
  CHECK(ate_percent(run) < 0.6);
  CHECK_THAT(read_file(run.at("folder").get<std::string>() + "/log.txt"),
             ContainsSubstring("front-end process: centres of dots") && ContainsSubstring(" tracks"));
}

TEST_CASE("A back-end process that crashes is a failed run with its last output, and the others are run", "[slow]") {
  const TemporaryFolder folder;
  Json config = short_config();
  config.erase("backend");
  folder.write("crash.py",
               "import sys\ninput(); print('{\"evbench\": 1}', flush=True); input()\nsys.exit('no idea what to do')\n");
  config["backends"] = {{{"type", "process"}, {"label", "crash"}, {"command", {"python3", "crash.py"}}},
                        {{"type", "bundle_adjustment"}, {"label", "frames"}}};
  folder.write("c.json", dump_json(config));
  CHECK(testing::evbench(folder, "run c.json --quiet").exit_code == 3);
  std::map<std::string, Json> runs = metrics(folder, "short");
  REQUIRE(runs.size() == 2);
  CHECK(runs["frames"].at("status").at("state") == "ok");
  CHECK(runs["crash"].at("status").at("state") == "failed");
  CHECK_THAT(
      runs["crash"].at("status").at("reason").get<std::string>(),
      ContainsSubstring(
          "the process \"python3 crash.py\" ended with exit code 1; last message to it: the batch until 0.01 s") &&
          ContainsSubstring("no idea what to do"));
}
