#include <fstream>
#include <iostream>

#include "bench/testing/configs.hpp"
#include "bench/testing/program.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;

// Checks the same configs by the JSON Schema for editors and by the program itself; the schema with an independent
// validator, Python's jsonschema.

namespace {

/// Prints a line for each config on the command line: "fine", or the error.
constexpr const char* kValidator = R"(
import json, sys
from jsonschema import Draft202012Validator
schema = json.load(open("schema.json"))
Draft202012Validator.check_schema(schema)
validator = Draft202012Validator(schema)
for name in sys.argv[1:]:
    errors = list(validator.iter_errors(json.load(open(name))))
    print("fine" if not errors else "wrong: " + errors[0].message.replace("\n", " ")[:300])
)";

class Schema {
 public:
  Schema() {
    folder_.write("validate.py", kValidator);
    folder_.write("schema.json", testing::evbench(folder_, "describe config --schema").out);
    write_recording(folder_);
  }

  /// Whether the schema and the program's --check accept the configs (files or JSON texts).
  void expect(const std::vector<Json>& configs, bool fine) const {
    std::string names;
    for (std::size_t i = 0; i < configs.size(); ++i) {
      const std::string name = "c" + std::to_string(i) + ".json";
      std::ofstream(folder_.file(name)) << configs[i];
      names += " " + name;
    }
    const Outcome validated = testing::shell(folder_, "/usr/bin/python3 validate.py" + names);
    CAPTURE(validated.err);
    REQUIRE(validated.exit_code == 0);
    std::istringstream lines(validated.out);
    for (std::size_t i = 0; i < configs.size(); ++i) {
      std::string line;
      REQUIRE(std::getline(lines, line));
      const Outcome checked = testing::evbench(folder_, "run --check c" + std::to_string(i) + ".json");
      CAPTURE(dump_json(configs[i]), line, checked.err);
      CHECK((line == "fine") == fine);
      CHECK((checked.exit_code == 0) == fine);
    }
  }

  /// Valid configs that need no files.
  void expect_fine_by_schema(const std::vector<std::string>& paths) const {
    std::string names;
    for (const std::string& path : paths) names += " '" + path + "'";
    const Outcome validated = testing::shell(folder_, "/usr/bin/python3 validate.py" + names);
    CAPTURE(validated.err, validated.out);
    CHECK(validated.exit_code == 0);
    CHECK(validated.out.find("wrong") == std::string::npos);
  }

  const TemporaryFolder& folder() const { return folder_; }

 private:
  TemporaryFolder folder_;
};

Json with(Json config, const char* pointer, const Json& value) {
  config[Json::json_pointer(pointer)] = value;
  return config;
}

}  // namespace

TEST_CASE("Every shipped config, and every config that a run writes, is valid by the schema", "[slow]") {
  const Schema schema;
  std::vector<std::string> paths = shipped_configs();
  CHECK(paths.size() >= 2);
  testing::evbench(schema.folder(), "run recording.json --quiet");  // fails, with fixed points; its config is written
  const std::set<std::string> runs = runs_of(schema.folder().file("results/recording"));
  REQUIRE(runs.size() == 1);
  paths.push_back(*runs.begin() + "/config.json");
  schema.expect_fine_by_schema(paths);
}

TEST_CASE("Valid configs are accepted by the schema and by the program", "[slow]") {
  const Json config = short_config();
  Schema().expect(
      {config, short_comparison(), with(config, "/$schema", "x.json"), with(config, "/backend/label", "a"),
       with(config, "/evaluation/time_range", {0, 1}), with(config, "/evaluation/time_range", Json::array()),
       with(config, "/seed", 3.0), short_config("gp_map")},
      true);
}

TEST_CASE("Invalid configs are rejected by the schema and by the program", "[slow]") {
  const Json config = short_config(), recording = with(config, "/source", {{"type", "recording"}});
  Json neither = config;
  neither.erase("backend");
  Schema().expect({neither,
                   with(config, "/backends", {{{"type", "gp_map"}}}),
                   with(neither, "/backends", Json::array()),
                   recording,
                   with(recording, "/source/folder", ""),
                   with(config, "/evaluation/time_range", {0}),
                   with(config, "/evaluation/time_range", {0, 1, 2}),
                   with(config, "/seed", -1),
                   with(config, "/seed", "1"),
                   with(config, "/seed", 1.5),
                   with(config, "/sede", 1),
                   with(config, "/backend/type", "gp_mop"),
                   with(config, "/backend/label", ""),
                   with(config, "/backend/label", 3),
                   with(config, "/source/duration", 0),
                   with(config, "/source/motion/kind", "stationary"),
                   with(config, "/plugins", "a.so"),
                   Json::array(),
                   Json("text"),
                   with(config, "/trajectory_rate", 1e6),
                   with(short_config("gp_map"), "/backend/qc", {1, 2, 3})},
                  false);
}
