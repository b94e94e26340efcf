#include <map>
#include <sstream>

#include "bench/published.hpp"
#include "bench/testing/program.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "eval/testing/runs.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// A folder of configs with the paper's numbers: one that runs, one whose data are missing.
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
           {"rows",
            {{{"label", "asynchronous"},
              {"over", "frames of 50 ms"},
              {"values", {{"ate.trans_m.rmse", {0.5, 4.0}}, {"rpe.trans_m.rmse", {3.0, 0.5}}}}},
             {{"label", "asynchronous"}, {"values", {{"times.backend_s", 60}}}}}}});
  }
  void write(const Json& result) const {
    folder.write("paper/published.json", dump_json({{"paper", "Somebody, 2022"}, {"results", {result}}}));
  }
  Outcome reproduce(const std::string& arguments) const {
    return testing::evbench(folder, "reproduce --configs paper --quiet " + arguments);
  }
};

}  // namespace

TEST_CASE("Published results are compared as ratios, with both protocols and why they can't be equal", "[slow]") {
  const Paper paper;
  const Outcome outcome = paper.reproduce("arm");
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  // The ratio of the runs' own errors, whatever their scale is.
  std::map<std::string, double> ate;
  for (const std::string& run : runs_of(paper.folder.file("results/arm"))) {
    const Json metrics = parse_json(read_file(run + "/metrics.json"));
    ate[metrics.at("label")] = metrics.at("final").at("ate").at("trans_m").at("rmse").get<double>();
  }
  const double ratio = ate.at("asynchronous") / ate.at("frames of 50 ms");
  const std::string row = line_with(outcome.out, " ATE ");
  INFO(outcome.out);
  CHECK_THAT(row, ContainsSubstring("asynchronous") && ContainsSubstring("frames of 50 ms") &&
                      ContainsSubstring(fmt::format(" {:.2g} ", ratio)) && ContainsSubstring(" 0.12 ") &&
                      ContainsSubstring(ratio < 1.0 ? "yes" : "no"));
  CHECK_THAT(line_with(outcome.out, " RPE "), ContainsSubstring(" 6 "));
  CHECK_THAT(line_with(outcome.out, "back-end [s]"), ContainsSubstring(" 60 "));
  CHECK_THAT(outcome.out, ContainsSubstring("Paper: Somebody, 2022.") &&
                              ContainsSubstring("arm (Table I). Here: Sim(3) alignment") &&
                              ContainsSubstring("Paper: not said. The recording is not public."));
  CHECK_THAT(paper.reproduce("arm --format csv").out,
             ContainsSubstring("arm,asynchronous,frames of 50 ms,ate.trans_m.rmse,") && ContainsSubstring(",0.125,") &&
                 ContainsSubstring("arm,asynchronous,,times.backend_s,") && ContainsSubstring(",60,\n"));
}

TEST_CASE("Configs whose data are missing are left out and listed, the others are run", "[slow]") {
  const Paper paper;
  const Outcome outcome = paper.reproduce("");
  CHECK(outcome.exit_code == 2);
  CHECK_THAT(outcome.err, ContainsSubstring("elsewhere is left out: ") && ContainsSubstring("nowhere"));
  CHECK_THAT(outcome.out, ContainsSubstring("asynchronous"));
  CHECK(names_in(paper.folder.file("results")) == std::set<std::string>{"arm"});
}

TEST_CASE("Unknown configs and damaged numbers are errors that name the place", "[slow]") {
  const Paper paper;
  CHECK_THAT(paper.reproduce("arn").err, ContainsSubstring("paper has no config \"arn\"; did you mean \"arm\"?"));
  paper.write({{"config", "arm"}, {"what", "Table I"}});
  CHECK_THAT(paper.reproduce("arm").err, ContainsSubstring("published.json: results.0: \"protocol\" is missing"));
  paper.write({{"config", "arm"},
               {"what", "Table I"},
               {"protocol", "not said"},
               {"rows", {{{"label", "a"}, {"over", "b"}, {"values", {{"ate.trans_m.rmse", 0.5}}}}}}});
  CHECK_THAT(paper.reproduce("arm").err, ContainsSubstring("two numbers above 0, of \"label\" and of \"over\""));
  CHECK_THAT(testing::evbench(paper.folder, "reproduce").err,
             ContainsSubstring("configs/paper: there is no such folder here") &&
                 ContainsSubstring("--configs REPOSITORY/configs/paper"));
}

TEST_CASE("Experiments of the reference results are run, and compared run by run with the committed numbers",
          "[slow]") {
  const Paper paper;
  const auto reproduce = [&](const std::string& arguments) {
    return testing::evbench(paper.folder, "reproduce --reference " + arguments);
  };
  CHECK_THAT(reproduce("arm").err, ContainsSubstring("results/reference/experiments.json: there is no such file here"));

  std::filesystem::create_directories(paper.folder.file("results/reference"));
  const Json arm = {{"name", "arm"},
                    {"commands", {"evbench sweep paper/arm.json --vary pipeline.interval=0.01,0.02 --quiet"}}};
  const Json unset = {{"name", "unset"}, {"needs", {"EVBENCH_NOT_SET"}}, {"commands", {"false"}}};
  const Json broken = {{"name", "broken"}, {"commands", {"exit 7"}}};
  paper.folder.write("results/reference/experiments.json", dump_json({{"experiments", {arm, unset, broken}}}));
  CHECK_THAT(reproduce("arn").err, ContainsSubstring("has no experiment \"arn\"; did you mean \"arm\"?"));
  CHECK_THAT(reproduce("unset").err, ContainsSubstring("unset: the environment variable EVBENCH_NOT_SET is not set"));
  CHECK_THAT(reproduce("broken").err, ContainsSubstring("broken: \"exit 7\" ended with 7"));

  CHECK_THAT(reproduce("arm --set seed=3").err, ContainsSubstring("excludes"));
  const Json stopped = {{"name", "stopped"}, {"commands", {"exit 130"}}};
  paper.folder.write("results/reference/experiments.json", dump_json({{"experiments", {stopped, arm}}}));
  const Outcome interrupted = reproduce("");
  CHECK(interrupted.exit_code == 130);
  CHECK_THAT(interrupted.out, !ContainsSubstring("arm"));

  REQUIRE(reproduce("arm -j 1").exit_code == 0);
  const Outcome made =
      testing::evbench(paper.folder, "table results/arm --format csv --all --out results/reference/arm.csv");
  INFO(made.err);
  REQUIRE(made.exit_code == 0);
  CHECK_THAT(reproduce("arm").out,
             ContainsSubstring("arm: 4 of 4 runs are in results/reference/arm.csv. ATE [m]: within 0 %"));

  // Another number in the line of one value of the axis.
  std::istringstream lines(read_file(paper.folder.file("results/reference/arm.csv")));
  std::string line, text;
  std::getline(lines, line);
  const auto column = std::count(line.begin(), line.begin() + line.find("ate.trans_m.rmse"), ',');
  for (text = line + "\n"; std::getline(lines, line); text += line + "\n") {
    if (!line.starts_with("arm,asynchronous,0.02,")) continue;
    std::size_t begin = 0;
    for (auto i = column; i > 0; --i) begin = line.find(',', begin) + 1;
    const std::size_t length = line.find(',', begin) - begin;
    line.replace(begin, length, fmt::format("{}", 0.5 * std::stod(line.substr(begin, length))));
  }
  paper.folder.write("results/reference/arm.csv", text);
  CHECK_THAT(reproduce("arm").out,
             ContainsSubstring("ATE [m]: within 1e+02 % (asynchronous, pipeline.interval 0.02, seed 1)."));
}

TEST_CASE("An installed program finds the installed configs", "[slow]") {
  const Paper paper;
  const auto copy = [&](const std::string& from, const std::string& to) {
    std::filesystem::create_directories(std::filesystem::path(paper.folder.file(to)).parent_path());
    std::filesystem::copy(from, paper.folder.file(to), std::filesystem::copy_options::recursive);
  };
  copy(EVBENCH_PROGRAM, "installed/bin/evbench");
  copy(paper.folder.file("paper"), "installed/share/evbench/configs/paper");
  const Outcome outcome =
      shell(paper.folder, "mkdir else && cd else && ../installed/bin/evbench reproduce arm --quiet");
  INFO(outcome.err);
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, ContainsSubstring("frames of 50 ms"));
}

TEST_CASE("Table I's claims are a tenth less error, whatever the scale") {
  const Published published = read_published(EVBENCH_CONFIGS "/paper/published.json");
  const auto table = std::ranges::find(published.results, "table1_simulated", &PublishedResult::config);
  REQUIRE(table != published.results.end());
  const PublishedRow& row = table->rows.at(0);
  REQUIRE(row.values.size() == 2);
  for (const PublishedValue& value : row.values) {
    CHECK(value.own / value.base.value() == Approx(value.metric == "rpe.trans_m.rmse" ? 0.91 : 0.89).margin(0.006));
  }
}

TEST_CASE("The paper's numbers belong to existing configs and back-ends") {
  const Published published = read_published(EVBENCH_CONFIGS "/paper/published.json");
  CHECK(published.results.size() >= 2);
  for (const PublishedResult& result : published.results) {
    INFO(result.config);
    const Json config = parse_json(read_file(EVBENCH_CONFIGS "/paper/" + result.config + ".json"));
    CHECK(config.at("name") == result.config);
    CHECK_FALSE(result.not_equal.empty());
    for (const PublishedRow& row : result.rows) {
      for (const std::string& label : {row.label, row.over}) {
        CHECK((label.empty() || std::ranges::any_of(config.at("backends"), [&](const Json& backend) {
                 return backend.at("label") == label;
               })));
      }
      CHECK_FALSE(row.values.empty());
    }
  }
}
