#include "bench/experiment.hpp"

#include <filesystem>

#include "bench/testing/configs.hpp"
#include "bench/testing/keys.hpp"
#include "bench/testing/program.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::EndsWith;

namespace {

Experiment read(const Json& config, const std::vector<std::string>& overrides = {}) {
  const TemporaryFolder folder;
  return read_experiment(folder.write("c.json", dump_json(config)), overrides, known_plugins());
}

Experiment read_text(const std::string& text) {
  const TemporaryFolder folder;
  return read_experiment(folder.write("c.json", text), {}, known_plugins());
}

}  // namespace

TEST_CASE("A config holds one run or a comparison whose runs share source, front-end and seed") {
  const Experiment one = read(short_config());
  REQUIRE(one.runs.size() == 1);
  CHECK(one.runs[0].label == "bundle_adjustment");
  const Experiment two = read(short_comparison());
  REQUIRE(two.runs.size() == 2);
  CHECK(two.runs[0].label == "asynchronous");
  CHECK(two.runs[0].job.source.options == two.runs[1].job.source.options);
  CHECK(key_of(two.runs[0]) != key_of(two.runs[1]));
}

TEST_CASE("An experiment without a name has that of its file") {
  Json config = short_config();
  config.erase("name");
  CHECK(read(config).name == "c");
}

TEST_CASE("A run's key depends on what determines the result and not on how it is written down") {
  const std::string key = key_of(read(short_config()).runs[0]);
  CHECK_THAT(key, Catch::Matchers::StartsWith("bundle_adjustment-"));
  Json same = short_config();
  same["description"] = "in other words";
  same["source"]["duration"] = 3.0;
  CHECK(key_of(read(same).runs[0]) == key);
  for (const char* other : {"seed=2", "trajectory_rate=50", "pipeline.interval=0.02", "source.duration=2.5",
                            "backend.batch_duration=0.07"}) {
    INFO(other);
    CHECK(key_of(read(short_config(), {other}).runs[0]) != key);
  }
  for (const char* same_job :
       {"name=other", "backend.label=mine", "evaluation.alignment=se3", "description=x", "pipeline.latency=0.02"}) {
    INFO(same_job);
    CHECK(key_of(read(short_config(), {same_job}).runs[0]) == key);
  }
}

TEST_CASE("A resolved config is complete, and read again it is the same run") {
  const Experiment first = read(short_comparison());
  for (const RunConfig& run : first.runs) {
    const Experiment again = read(run.resolved());
    REQUIRE(again.runs.size() == 1);
    CHECK(again.runs[0].label == run.label);
    CHECK(key_of(again.runs[0]) == key_of(run));
    CHECK(again.runs[0].resolved() == run.resolved());
  }
}

TEST_CASE("Relative paths are taken from the config's folder, variables stay for other machines") {
  const TemporaryFolder folder;
  write_recording(folder);
  const std::string path = folder.file("recording.json");
  const Json config =
      read_experiment(path, {"source.ground_truth=${EVBENCH_DATA}/x.txt"}, known_plugins()).runs[0].resolved();
  CHECK(config["frontend"]["tracks"] == folder.file("tracks.txt"));
  CHECK(config["source"]["ground_truth"] == "${EVBENCH_DATA}/x.txt");
  CHECK(config["source"]["calibration"] == "");
}

TEST_CASE("Overrides reach values, list items and whole objects") {
  const Experiment experiment =
      read(short_comparison(), {"seed=7", "backends.1.batch_duration=0.2", "backends.1.label=200 ms",
                                "evaluation.time_range=[0, 1]", "source.motion={\"kind\": \"robot_arm\"}"});
  CHECK(experiment.runs[0].job.seed == 7);
  CHECK(experiment.runs[1].label == "200 ms");
  CHECK(experiment.runs[1].job.backend.options["batch_duration"] == 0.2);
  CHECK(experiment.runs[0].evaluation.time_range == std::vector<double>{0.0, 1.0});
  CHECK(experiment.runs[0].job.source.options["motion"]["kind"] == "robot_arm");
}

TEST_CASE("An invalid override is an error") {
  CHECK_THROWS_WITH(read(short_config(), {"seed"}), ContainsSubstring("--set seed: expected KEY=VALUE"));
  CHECK_THROWS_WITH(read(short_config(), {"=3"}), ContainsSubstring("expected KEY=VALUE"));
  CHECK_THROWS_WITH(read(short_comparison(), {"backends.2.label=x"}),
                    ContainsSubstring("not a position in a list of 2"));
  CHECK_THROWS_WITH(read(short_comparison(), {"backends.first.label=x"}),
                    ContainsSubstring("\"first\" is not a position"));
  CHECK_THROWS_WITH(read(short_config(), {"name.x=3"}), ContainsSubstring("is a value, not an object"));
  CHECK_THROWS_WITH(read(short_config(), {"sede=3"}),
                    ContainsSubstring("\"sede\"") && ContainsSubstring("did you mean \"seed\""));
  CHECK_THROWS_WITH(read(short_config(), {"seed=1e999"}), ContainsSubstring("c.json: seed: expected integer"));
  CHECK_THROWS_WITH(read(short_config(), {"trajectory_rate=NaN"}), ContainsSubstring("expected number, found \"NaN\""));
}

TEST_CASE(
    "An override gives text where text is expected, and a position of a list that the config leaves at its default") {
  CHECK(read(short_config(), {"backend.label=0.05"}).runs[0].label == "0.05");
  CHECK(read(short_config(), {"name=2024"}).name == "2024");
  const Json twice = read(short_config("gp_map"), {"backend.qc.3=2"}).runs[0].job.backend.options["qc"];
  const Json before = read(short_config("gp_map")).runs[0].job.backend.options["qc"];
  REQUIRE(twice.size() == before.size());
  for (std::size_t i = 0; i < before.size(); ++i) CHECK(twice[i] == (i == 3 ? Json(2.0) : before[i]));
  CHECK_THROWS_WITH(read(short_config("gp_map"), {"backend.qc.6=2"}),
                    ContainsSubstring("\"6\" is not a position in a list of 6"));
}

TEST_CASE("An error in what --set gave says so, an error in the file does not") {
  CHECK_THROWS_WITH(
      read(short_config(), {"trajectory_rate=fast"}),
      ContainsSubstring("c.json: trajectory_rate: expected number") && EndsWith("(from --set trajectory_rate=fast)"));
  CHECK_THROWS_WITH(read(short_config(), {"seed=2", "source.motion.knid=3"}),
                    ContainsSubstring("unknown key \"knid\"") && EndsWith("(from --set source.motion.knid=3)"));
  CHECK_THROWS_WITH(read(short_config(), {"source={\"type\": \"simulation\", \"duration\": -1}"}),
                    ContainsSubstring("source.duration") && ContainsSubstring("(from --set source="));
  Json config = short_config();
  config["source"]["duration"] = -1;
  CHECK_THROWS_WITH(read(config, {"seed=2"}), ContainsSubstring("source.duration") && !ContainsSubstring("--set"));
}

TEST_CASE("A config may name its schema") {
  Json config = short_config();
  config["$schema"] = "evbench.schema.json";
  CHECK(key_of(read(config).runs[0]) == key_of(read(short_config()).runs[0]));
  CHECK_FALSE(read(config).runs[0].resolved().contains("$schema"));
}

TEST_CASE("An invalid config is an error with the place and the nearest name") {
  CHECK_THROWS_WITH(read_experiment("/no/such.json", {}, known_plugins()),
                    ContainsSubstring("/no/such.json: no such file"));
  CHECK_THROWS_WITH(read_experiment("/", {}, known_plugins()),
                    ContainsSubstring("is a folder; expected a JSON config"));
  CHECK_THROWS_WITH(read_text(""), ContainsSubstring("c.json: is not JSON"));
  CHECK_THROWS_WITH(read_text("{\"name\": "), ContainsSubstring("c.json: is not JSON") && ContainsSubstring("line 1"));
  CHECK_THROWS_WITH(read_text(R"({"seed": 1, "source": {"seed": 3}, "seed": 2})"),
                    ContainsSubstring("c.json: an object has the key \"seed\" twice"));
  CHECK_THROWS_WITH(read_text("[]"), ContainsSubstring("expected an object"));
  CHECK_THROWS_WITH(read_text("{}"), ContainsSubstring("\"source\" is missing"));
  const auto with = [](const char* pointer, const Json& value) {
    Json config = short_config();
    config[Json::json_pointer(pointer)] = value;
    return config;
  };
  CHECK_THROWS_WITH(
      read(with("/backend/type", "gp_mop")),
      ContainsSubstring("c.json: backend.type: no backend is called \"gp_mop\"; did you mean \"gp_map\"?"));
  CHECK_THROWS_WITH(read(with("/frontend/type", "orakle")), ContainsSubstring("did you mean \"oracle\""));
  CHECK_THROWS_WITH(read(with("/source/type", "simulator")), ContainsSubstring("did you mean \"simulation\""));
  CHECK_THROWS_WITH(read(with("/source/type", 3)),
                    ContainsSubstring("c.json: source: expected an object with \"type\""));
  CHECK_THROWS_WITH(read(with("/source/motion/knid", 3)),
                    ContainsSubstring("c.json: source.motion: unknown key \"knid\"; did you mean \"kind\""));
  CHECK_THROWS_WITH(read(with("/source/duration", -1)),
                    ContainsSubstring("c.json: source.duration: -1 is out of range"));
  CHECK_THROWS_WITH(read(with("/source/duration", 1e12)), ContainsSubstring("expected above 0 to 36000"));
  CHECK_THROWS_WITH(read(with("/evaluation/alignment", "sim4")), ContainsSubstring("c.json: evaluation.alignment"));
  CHECK_THROWS_WITH(read(with("/backend/label", "")), ContainsSubstring("c.json: backend.label: expected text"));
  CHECK_THROWS_WITH(read(with("/backends", Json::array())), ContainsSubstring("either \"backend\""));
  CHECK_THROWS_WITH(read(with("/seed", -1)), ContainsSubstring("c.json: seed"));
  for (const char* name : {"a/b", "..", ".hidden", "a b"}) {
    CHECK_THROWS_WITH(read(with("/name", name)), ContainsSubstring("can't name a folder"));
  }
  CHECK_NOTHROW(read(with("/name", std::string(255, 'n'))));
  CHECK_THROWS_WITH(read(with("/name", std::string(256, 'n'))),
                    ContainsSubstring("has 256 characters; expected at most 255, as it names a folder"));
}

TEST_CASE("Paths of libraries in a config are resolved from its folder, and are written to the run's config") {
  const TemporaryFolder folder;
  Json config = short_config();
  config["plugins"] = {"lib/libmine.so", "/opt/libother.so"};
  const std::string path = folder.write("c.json", dump_json(config));
  const std::vector<std::string> expected = {folder.file("lib/libmine.so"), "/opt/libother.so"};
  CHECK(read_plugin_paths(path, {}) == expected);
  CHECK(read_experiment(path, {}, known_plugins()).runs[0].resolved().at("plugins") == Json(expected));
  CHECK(read_plugin_paths(path, {"plugins=[]"}).empty());
  CHECK_THROWS_WITH(read_plugin_paths(path, {"plugins=libmine.so"}),
                    ContainsSubstring("c.json: plugins: expected a list of paths, found \"libmine.so\""));
  CHECK_THROWS_WITH(read_plugin_paths(path, {"plugins.0=3"}), ContainsSubstring("expected a list of paths"));
}

TEST_CASE("A library of the command line is written to the run's config") {
  Plugins plugins = registered_plugins();
  Registry<BackEnd>::Entry entry = plugins.of<BackEnd>().find("gp_map", "test");
  entry.origin = "/opt/libmine.so";
  plugins.of<BackEnd>().add("mine", entry);
  const TemporaryFolder folder;
  const std::string path = folder.write("c.json", dump_json(short_config("mine")));
  for (const std::vector<std::string>& overrides : {std::vector<std::string>{}, {"plugins=[\"/opt/libmine.so\"]"}}) {
    CHECK(read_experiment(path, overrides, plugins).runs[0].resolved().at("plugins") == Json{"/opt/libmine.so"});
  }
}

TEST_CASE("Runs of a comparison that would write to the same folder are an error") {
  CHECK_THROWS_WITH(read(short_comparison(), {"backends.1.label=asynchronous"}),
                    ContainsSubstring("two back-ends are labelled \"asynchronous\""));
  Json config = short_comparison();
  config["backends"] = Json::array();
  CHECK_THROWS_WITH(read(config), ContainsSubstring("at least one back-end"));
}

TEST_CASE("Every config that comes with evbench can be read, and each of its runs run again") {
  const std::vector<std::string> paths = shipped_configs();
  CHECK(paths.size() >= 2);
  for (const std::string& path : paths) {
    INFO(path);
    for (const RunConfig& run : read_experiment(path, {}, known_plugins()).runs) {
      CHECK(read(run.resolved()).runs.at(0).resolved() == run.resolved());
    }
  }
}

TEST_CASE("The schema of a config knows every plugin and its options") {
  const Json schema = experiment_schema(known_plugins());
  const Json& backends = schema.at("properties").at("backend").at("anyOf");
  CHECK(backends.size() == known_plugins().of<BackEnd>().entries().size());
  for (const Json& backend : backends) CHECK(backend.at("properties").contains("type"));
  CHECK_THAT(describe_experiment(), ContainsSubstring("evaluation.alignment") && ContainsSubstring("trajectory_rate") &&
                                        ContainsSubstring("pipeline.latency"));
}
