#include "bench/published.hpp"
#include "bench/testing/program.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// A folder of configs with the paper's numbers: one that runs here, one whose data is not here.
struct Paper {
  TemporaryFolder folder;

  Paper() {
    Json config = short_comparison();
    config["name"] = "arm";
    std::filesystem::create_directories(folder.file("paper"));
    folder.write("paper/arm.json", dump_json(config));
    config["name"] = "elsewhere";
    config["source"] = {{"type", "recording"}, {"folder", "nowhere"}};
    folder.write("paper/elsewhere.json", dump_json(config));
    write({{"config", "arm"},
           {"what", "Table I"},
           {"protocol", "not said"},
           {"not_equal", "The recording is not public."},
           {"rows", {{{"label", "asynchronous"}, {"values", {{"ate.trans_m.rmse", 0.5}, {"times.backend_s", 60}}}}}}});
  }
  void write(const Json& result) const {
    folder.write("paper/published.json", dump_json({{"paper", "Somebody, 2022"}, {"results", {result}}}));
  }
  Outcome reproduce(const std::string& arguments) const {
    return testing::evbench(folder, "reproduce --configs paper --quiet " + arguments);
  }
};

}  // namespace

TEST_CASE("Our numbers and the paper's stand side by side, with both protocols and why they can't be equal", "[slow]") {
  const Paper paper;
  const Outcome outcome = paper.reproduce("arm");
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, ContainsSubstring("asynchronous") && ContainsSubstring("ATE [m]") &&
                              ContainsSubstring("0.5") && ContainsSubstring("60"));
  CHECK_THAT(outcome.out, ContainsSubstring("Paper: Somebody, 2022.") &&
                              ContainsSubstring("arm (Table I). Here: Sim(3) alignment") &&
                              ContainsSubstring("Paper: not said. The recording is not public."));
  CHECK_THAT(paper.reproduce("arm --format csv").out, ContainsSubstring("arm,asynchronous,ate.trans_m.rmse,0.") &&
                                                          ContainsSubstring(",0.5,") && ContainsSubstring(",60,"));
}

TEST_CASE("Configs whose data is not here are left out and named, the others are done", "[slow]") {
  const Paper paper;
  const Outcome outcome = paper.reproduce("");
  CHECK(outcome.exit_code == 2);
  CHECK_THAT(outcome.err, ContainsSubstring("elsewhere is left out: ") && ContainsSubstring("nowhere"));
  CHECK_THAT(outcome.out, ContainsSubstring("asynchronous"));
  CHECK(names_in(paper.folder.file("results")) == std::set<std::string>{"arm"});
}

TEST_CASE("Names that are no configs and damaged numbers are refused with the place", "[slow]") {
  const Paper paper;
  CHECK_THAT(paper.reproduce("arn").err, ContainsSubstring("paper has no config \"arn\"; did you mean \"arm\"?"));
  paper.write({{"config", "arm"}, {"what", "Table I"}});
  CHECK_THAT(paper.reproduce("arm").err, ContainsSubstring("published.json: results.0: \"protocol\" is missing"));
  CHECK_THAT(testing::evbench(paper.folder, "reproduce").err,
             ContainsSubstring("configs/paper: there is no such folder here") &&
                 ContainsSubstring("--configs REPOSITORY/configs/paper"));
}

TEST_CASE("The paper's numbers are of configs and back-ends that there are") {
  const Published published = read_published(EVBENCH_CONFIGS "/paper/published.json");
  CHECK(published.results.size() >= 2);
  for (const PublishedResult& result : published.results) {
    INFO(result.config);
    const Json config = parse_json(read_file(EVBENCH_CONFIGS "/paper/" + result.config + ".json"));
    CHECK(config.at("name") == result.config);
    CHECK_FALSE(result.not_equal.empty());
    for (const PublishedRow& row : result.rows) {
      CHECK(std::ranges::any_of(config.at("backends"),
                                [&](const Json& backend) { return backend.at("label") == row.label; }));
      CHECK_FALSE(row.values.empty());
    }
  }
}
