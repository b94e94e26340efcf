#include <filesystem>
#include <set>
#include <string>
#include <utility>

#include "bench/testing/keys.hpp"
#include "bench/testing/program.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;

namespace {

/// Configs of examples: those with built-in plugins only, and those that need another program.
std::vector<std::string> example_configs() {
  std::vector<std::string> paths;
  const std::filesystem::path configs = EVBENCH_CONFIGS;
  for (const auto& entry : std::filesystem::directory_iterator(configs / "examples")) {
    if (entry.path().extension() == ".json") paths.push_back(entry.path().string());
  }
  for (const auto& entry : std::filesystem::directory_iterator(configs / "../examples")) {
    const std::filesystem::path config = entry.path() / "config.json";
    if (std::filesystem::exists(config)) paths.push_back(config.string());
  }
  return paths;
}

template <class Interface>
std::set<std::string> built_in() {
  std::set<std::string> names;
  for (const auto& [name, entry] : known_plugins().of<Interface>().entries()) {
    if (entry.origin == kBuiltIn) names.insert(name);
  }
  return names;
}

}  // namespace

TEST_CASE("Each built-in front-end and back-end, and each sensible pair of them, is in an example") {
  std::set<std::string> frontends, backends;
  std::set<std::pair<std::string, std::string>> pairs;
  for (const std::string& path : example_configs()) {
    const Json config = parse_json(read_file(path));
    const std::string frontend = config.at("frontend").at("type");
    frontends.insert(frontend);
    const Json all = config.contains("backends") ? config.at("backends") : Json::array({config.at("backend")});
    for (const Json& backend : all) {
      backends.insert(backend.at("type").get<std::string>());
      pairs.emplace(frontend, backend.at("type"));
    }
  }
  REQUIRE_FALSE(built_in<FrontEnd>().empty());
  CHECK(frontends == built_in<FrontEnd>());
  CHECK(backends == built_in<BackEnd>());
  for (const char* frontend : {"haste", "poisson", "str", "dots", "recorded", "oracle"}) {
    CAPTURE(frontend);
    CHECK(pairs.contains({frontend, "gp_map"}));
    CHECK(pairs.contains({frontend, "bundle_adjustment"}));
  }
  // Pure rotation gives no map.
  for (const char* frontend : {"haste", "str_motion", "oracle"}) {
    CAPTURE(frontend);
    CHECK(pairs.contains({frontend, "rotation_averaging"}));
  }
}

TEST_CASE("Examples without external data pass --check, and the one with tracks from a file runs", "[slow]") {
  const TemporaryFolder folder;
  int without_data = 0;
  for (const std::string& path : example_configs()) {
    const std::string text = read_file(path);
    // process_examples.test.cpp runs those that need Python.
    if (text.find("${EVBENCH_DATA}") != std::string::npos || text.find("\"process\"") != std::string::npos) continue;
    ++without_data;
    const Outcome checked = testing::evbench(folder, "run --check '" + path + "'");
    CAPTURE(path, checked.err);
    CHECK(checked.exit_code == 0);
  }
  CHECK(without_data >= 8);
  const Outcome run = testing::evbench(
      folder, "run '" + std::string(EVBENCH_CONFIGS) + "/examples/tracks_from_file.json' --quiet --out results");
  CAPTURE(run.err);
  CHECK(run.exit_code == 0);
  for (const std::string& path : runs_of(folder.file("results/tracks_from_file"))) {
    CHECK(parse_json(read_file(path + "/status.json")).at("state") == "ok");
  }
}
