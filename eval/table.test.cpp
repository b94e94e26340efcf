#include "eval/table.hpp"

#include <catch2/catch.hpp>
#include <filesystem>

#include "core/testing/data.hpp"
#include "eval/scores.hpp"
#include "eval/table_text.hpp"
#include "eval/testing/trajectories.hpp"

namespace evbench {
namespace {

using namespace testing;
using Catch::Matchers::Contains;

Json scores_with(double ate, const std::string& alignment = "sim3") {
  const PoseTrajectory truth = sample(wavy_pose, 100, 0.01);
  ScoreOptions options;
  options.alignment = alignment;
  Json json = to_json(score(truth, disturbed(truth), options));
  json["ate"]["trans_m"]["rmse"] = ate;
  return json;
}

Json run(const std::string& experiment, const std::string& label, const Json& final_scores,
         const std::string& state = "ok") {
  RunRecord record;
  record.experiment = experiment;
  record.label = label;
  record.seed = 7;
  record.key = "mine-0123456789";
  record.final_scores = final_scores;
  record.runtime_s = 2.0;
  record.data_s = 3.0;
  record.realtime_factor = 1.5;
  record.times = {0.25, 1.75, 0.5, 0.125, 2.5};
  record.peak_rss_mib = 30.0;
  Json json = to_json(record);
  json["status"] = {{"state", state}, {"reason", ""}, {"time", 3.25}};
  return json;
}

/// Runs below a folder of results, as `evbench run` leaves them.
struct Results {
  TemporaryFolder folder;
  void add(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories(folder.file(name));
    folder.write(name + "/metrics.json", content);
  }
  void add(const std::string& name, const Json& metrics) const { add(name, metrics.dump()); }
  std::vector<RunRecord> find() const { return find_runs(std::vector{folder.path()}); }
  std::string table(const TableOptions& options) const { return make_table(find(), options); }
};

std::string line_with(const std::string& text, const std::string& part) {
  const std::size_t at = text.find(part);
  if (at == std::string::npos) return "";
  const std::size_t begin = text.rfind('\n', at) + 1;
  return text.substr(begin, text.find('\n', at) - begin);
}

}  // namespace

TEST_CASE("Runs are found in all folders below, complete ones only, in natural order") {
  Results results;
  results.add("x/key1", run("arm", "bundle 100 ms", scores_with(0.1)));
  results.add("x/key2", run("arm", "bundle 25 ms", scores_with(0.2)));
  results.add("y/deep/key3", run("arm", "asynchronous", scores_with(0.3)));
  results.add("x/key4.part", run("arm", "half", scores_with(0.3)));
  results.add("x/key5.old", run("arm", "replaced", scores_with(0.3)));
  const auto runs = results.find();
  REQUIRE(runs.size() == 3);
  CHECK(runs[0].label == "asynchronous");
  CHECK(runs[1].label == "bundle 25 ms");
  CHECK(runs[2].label == "bundle 100 ms");
  CHECK(find_runs(std::vector{results.folder.path(), results.folder.file("x")}).size() == 3);
}

TEST_CASE("Names compare with their numbers as numbers") {
  CHECK(natural_less("a 9", "a 10"));
  CHECK_FALSE(natural_less("a 10", "a 9"));
  CHECK(natural_less("a", "a 1"));
  CHECK(natural_less("a 01", "a 1") != natural_less("a 1", "a 01"));
  CHECK_FALSE(natural_less("a 1", "a 1"));
}

TEST_CASE("Folders without runs and damaged metrics are errors with the place") {
  Results results;
  CHECK_THROWS_WITH(results.find(), Contains("no metrics.json in it or below"));
  CHECK_THROWS_WITH(find_runs(std::vector<std::string>{"/nowhere"}), "/nowhere: is not a folder");
  const auto message = [](const std::string& content) -> std::string {
    Results damaged;
    damaged.add("key", content);
    try {
      damaged.find();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  CHECK_THAT(message("{\"final\": "), Contains("key/metrics.json: is not JSON"));
  CHECK_THAT(message("[1, 2]"), Contains("expected a JSON object"));
  CHECK_THAT(message("{\"label\": \"a\"}"), Contains("\"final\" is missing"));
  CHECK_THAT(message("{\"final\": null, \"online\": null}"), Contains("\"experiment\" is missing"));
}

TEST_CASE("A table shows the protocol, and the best value of each column") {
  Results results;
  results.add("a", run("arm", "asynchronous", scores_with(0.012)));
  results.add("b", run("arm", "bundle", scores_with(0.034)));
  const std::string text = results.table({});
  CHECK_THAT(line_with(text, "asynchronous"), Contains("0.0120*"));
  CHECK_THAT(line_with(text, "bundle"), Contains("0.0340") && !Contains("0.0340*"));
  CHECK_THAT(text, Contains("Experiment: arm.") && Contains("Protocol: Sim(3) alignment on all poses; nearest ground "
                                                            "truth within 0.01 s; RPE over 0.1 seconds, all pairs"));
  CHECK_THAT(results.table({.format = TableFormat::markdown}), Contains("**0.0120**"));
  CHECK_THAT(results.table({.format = TableFormat::latex}), Contains("\\textbf{0.0120}") && Contains("\\caption{"));
}

TEST_CASE("Only runs of one experiment and protocol that kept track compete") {
  Results results;
  results.add("a", run("arm", "good", scores_with(0.020)));
  results.add("b", run("arm", "better but lost", scores_with(0.010), "lost"));
  results.add("c", run("arm", "worse", scores_with(0.030)));
  results.add("d", run("arm", "other protocol", scores_with(0.001, "se3")));
  results.add("e", run("poster", "other experiment", scores_with(0.002)));
  const std::string text = results.table({});
  CHECK_THAT(line_with(text, "good"), Contains("0.02000*"));
  CHECK_THAT(line_with(text, "better but lost"), Contains("lost at 3.25 s") && !Contains("0.01000*"));
  CHECK_THAT(line_with(text, "other protocol"), !Contains("0.00100*"));
  CHECK_THAT(line_with(text, "other experiment"), Contains("poster") && !Contains("0.00200*"));
  CHECK_THAT(text, Contains("Protocol 1: ") && Contains("Protocol 2: ") && Contains("do not compete"));
}

TEST_CASE("A run without an estimate is a row without values") {
  Results results;
  results.add("a", run("arm", "good", scores_with(0.020)));
  results.add("b", run("arm", "bad", nullptr, "failed"));
  CHECK_THAT(line_with(results.table({}), "bad"), Contains(" - ") && Contains("failed at 3.25 s"));
  CHECK_THROWS_WITH(results.table({.online = true}), "none of the 2 runs has online scores");
}

TEST_CASE("Runs that could not be scored still make a table") {
  Results results;
  results.add("a", run("arm", "no ground truth", nullptr));
  CHECK_THAT(line_with(results.table({}), "no ground truth"), Contains("1.50") && Contains("ok"));
  CHECK_THAT(results.table({}), Contains("No run has scores") && Contains("no ground truth: not known"));
}

TEST_CASE("Columns can be chosen; pairs, coverage and scale then stand below") {
  Results results;
  results.add("a", run("arm", "one", scores_with(0.020)));
  results.add("b", run("arm", "two", scores_with(0.030)));
  const std::string text = results.table({.metrics = {"rpe.trans_m.median", "peak_rss_mib"}});
  CHECK_THAT(text, Contains("rpe.trans_m.median") && Contains("peak_rss_mib") && !Contains("ATE [m]"));
  CHECK_THAT(text, Contains("pairs 100 to 100; covered [%] 100.0 to 100.0; scale "));
  CHECK_THROWS_WITH(results.table({.metrics = {"rpe.trans_m.meddian"}}),
                    Contains("no run has the metric \"rpe.trans_m.meddian\"") && Contains("rpe.trans_m.median"));
}

TEST_CASE("Runs that differ in their seed, or in nothing but their options, can be told apart") {
  Results results;
  const auto add = [&](const std::string& name, int seed, const std::string& key) {
    Json json = run("arm", "mine", scores_with(0.02));
    json["seed"] = seed;
    json["key"] = key;
    results.add(name, json);
  };
  add("a", 1, "mine-aa");
  CHECK_THAT(results.table({}), !Contains("seed") && !Contains("mine-aa"));
  add("b", 2, "mine-bb");
  CHECK_THAT(results.table({}), Contains("seed") && !Contains("mine-aa"));
  add("c", 2, "mine-cc");
  CHECK_THAT(results.table({}), Contains("key") && Contains("mine-bb") && Contains("mine-cc"));
}

TEST_CASE("Front-end and back-end have a time each, and every time can be a column") {
  Results results;
  results.add("a", run("arm", "one", scores_with(0.020)));
  CHECK_THAT(line_with(results.table({}), "ATE [m]"), Contains("front-end [s]") && Contains("back-end [s]"));
  CHECK_THAT(line_with(results.table({}), "one"), Contains(" 0.250") && Contains(" 1.75"));
  CHECK_THAT(line_with(results.table({.metrics = {"times.waiting_s", "times.harness_s", "data_s"}}), "one"),
             Contains("0.500") && Contains("0.125") && Contains("3.00"));
  CHECK_THROWS_WITH(results.table({.metrics = {"times.waitng_s"}}), Contains("times.waiting_s"));
}

TEST_CASE("Below a table stands why runs have no scores") {
  Results results;
  results.add("a", run("arm", "good", scores_with(0.020)));
  Json bad = run("arm", "bad", nullptr, "failed");
  bad["status"]["reason"] = "2 tracks at 3.051 s, 15 needed";
  results.add("b", bad);
  Json unscored = run("arm", "unscored", nullptr);
  unscored["final_unscored"] = "only 2 of the estimate's poses have ground truth";
  results.add("c", unscored);
  CHECK_THAT(results.table({}), Contains("Without scores: bad: 2 tracks at 3.051 s, 15 needed.") &&
                                    Contains("Without scores: unscored: only 2 of the estimate's poses"));
}

TEST_CASE("CSV has the exact numbers under the keys of metrics.json") {
  Results results;
  results.add("a", run("arm, left", "say \"one\"", scores_with(0.0123456789)));
  const std::string csv = results.table({.format = TableFormat::csv, .metrics = {"ate.trans_m.rmse"}});
  CHECK(csv.substr(0, csv.find('\n')) ==
        "experiment,label,seed,key,folder,ate.trans_m.rmse,pairs,coverage,scale,status,protocol");
  CHECK_THAT(csv, Contains("\n\"arm, left\",\"say \"\"one\"\"\",7,mine-0123456789," + results.folder.file("a") +
                           ",0.0123456789,100,1,"));
}

TEST_CASE("Characters with a meaning in LaTeX and Markdown are escaped") {
  CHECK(escape_latex("50 % of a_b & {c} #1 $x^2~\\y") ==
        "50 \\% of a\\_b \\& \\{c\\} \\#1 \\$x\\textasciicircum{}2\\textasciitilde{}\\textbackslash{}y");
  CHECK(escape_latex("[a]") == "{[}a]");
  Results results;
  results.add("a", run("arm", "a|b_c", scores_with(0.02)));
  CHECK_THAT(results.table({.format = TableFormat::markdown}), Contains("a\\|b\\_c"));
}

}  // namespace evbench
