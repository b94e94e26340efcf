#include <filesystem>

#include "bench/testing/program.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// Runs the short comparison.
struct ScoredRuns {
  TemporaryFolder folder;
  std::vector<std::string> runs;

  ScoredRuns() {
    folder.write("c.json", dump_json(short_comparison()));
    REQUIRE(testing::evbench(folder, "run c.json --quiet").exit_code == 0);
    for (const std::string& run : runs_of(folder.file("results/short"))) runs.push_back(run);
  }
  std::string sums() const {
    return testing::shell(folder, "cd results && find . -type f | sort | xargs sha256sum").out;
  }
  Outcome score(const std::string& arguments) const { return testing::evbench(folder, "score " + arguments); }
};

Json json_file(const std::string& path) { return parse_json(read_file(path)); }

}  // namespace

TEST_CASE("Scored again by the same protocol, a run's files are identical", "[slow]") {
  const ScoredRuns runs;
  const std::string before = runs.sums();
  const Outcome outcome = runs.score("results");
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.out == testing::evbench(runs.folder, "table results").out);
  CHECK(runs.sums() == before);
  CHECK(runs.score("'" + runs.runs[0] + "/' --quiet").out.empty());
  CHECK(runs.sums() == before);
}

TEST_CASE("Runs are scored by another protocol, and by the one before again", "[slow]") {
  const ScoredRuns runs;
  const std::string before = runs.sums();
  const Outcome outcome = runs.score(
      "--set evaluation.alignment=se3 --set evaluation.rpe_delta=0.5 --set 'evaluation.time_range=[1,2]' results");
  REQUIRE(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, ContainsSubstring("SE(3) alignment") && ContainsSubstring("only 1 to 2 s") &&
                              ContainsSubstring("RPE over 0.5 s"));
  for (const std::string& run : runs.runs) {
    CHECK(json_file(run + "/metrics.json").at("final").at("alignment").at("method") == "se3");
    CHECK(json_file(run + "/config.json").at("evaluation").at("alignment") == "se3");
  }
  REQUIRE(runs.score("results --config c.json --quiet").exit_code == 0);
  CHECK(runs.sums() == before);
}

TEST_CASE("Scores of a run are those that eval gives for its files", "[slow]") {
  const ScoredRuns runs;
  const std::string path = "'" + runs.runs[0] + "/";
  REQUIRE(
      testing::evbench(runs.folder, "eval " + path + "groundtruth.tum' " + path +
                                        "final.tum' -as --interpolate --t_start 0 --t_end 3 -d 0.1 -u s --all_pairs "
                                        "--json e.json")
          .exit_code == 0);
  CHECK(json_file(runs.folder.file("e.json")).at("final") == json_file(runs.runs[0] + "/metrics.json").at("final"));
}

TEST_CASE("A run that can't be scored is an error, and no run is changed", "[slow]") {
  const ScoredRuns runs;
  const std::string before = runs.sums();
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    const Outcome outcome = runs.score(arguments);
    INFO(arguments);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, ContainsSubstring(message));
    CHECK(runs.sums() == before);
  };
  refused("nowhere", "nowhere: is not a folder");
  refused("results --set seed=2", "--set seed=2: expected evaluation.KEY=VALUE");
  refused("results --set evaluation.alignment=sim4", "did you mean \"sim3\"");
  refused("results --set evaluation.algnment=sim3", "unknown key \"algnment\"");
  refused("results --config no.json", "no.json: no such file");
  refused("results --set 'evaluation.time_range=[100,200]'", "has scores, but would have none by this protocol: ");
  std::filesystem::remove(runs.runs[1] + "/config.json");
  const Outcome outcome = runs.score("results");
  CHECK(outcome.exit_code == 2);
  CHECK_THAT(outcome.err,
             ContainsSubstring(runs.runs[1].substr(runs.folder.path().size() + 1) + "/config.json: can't be read"));
}

TEST_CASE("A run without ground truth says so, also when it is scored again", "[slow]") {
  const ScoredRuns runs;
  std::filesystem::remove(runs.runs[0] + "/groundtruth.tum");
  const Outcome outcome = runs.score("results");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, ContainsSubstring("no ground truth"));
  CHECK(json_file(runs.runs[0] + "/metrics.json").at("final_unscored") == "no ground truth");
}
