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
  record.times = {0.75, 0.25, 1.75, 0.5, 0.125, 2.5};
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
  void add(const std::string& name, const Json& metrics, const Json& config) const {
    add(name, metrics);
    folder.write(name + "/config.json", config.dump());
  }
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

TEST_CASE("Runs of one label have as columns the settings in which they differ, in the order of their values") {
  Results results;
  int folders = 9;
  for (const double duration : {0.05, 0.1}) {
    for (const int seed : {2, 1}) {
      Json json = run("arm", "bundle_adjustment", scores_with(0.02));
      json["seed"] = seed;
      results.add(std::to_string(folders--), json,
                  {{"seed", seed},
                   {"source", {{"type", "simulation"}}},
                   {"backend", {{"type", "bundle_adjustment"}, {"frame_duration", duration}, {"label", "x"}}}});
    }
  }
  const std::string text = results.table({});
  CHECK_THAT(line_with(text, "ATE [m]"), Contains("backend.frame_duration") && Contains("seed") && !Contains("key"));
  CHECK_THAT(text, !Contains("source.type") && !Contains("backend.label"));
  const auto runs = results.find();
  CHECK(runs[0].seed == 1);
  CHECK(runs[1].seed == 2);
  CHECK(*find_setting(runs[1].settings, "backend.frame_duration") == 0.05);
  CHECK(*find_setting(runs[2].settings, "backend.frame_duration") == 0.1);
  CHECK_THAT(results.table({.format = TableFormat::csv}),
             Contains("experiment,label,backend.frame_duration,seed,key,folder,") &&
                 Contains("\narm,bundle_adjustment,0.05,1,"));
}

TEST_CASE("Labels that tell runs apart need no settings beside them") {
  Results results;
  results.add("a", run("arm", "25 ms", scores_with(0.02)), {{"backend", {{"frame_duration", 0.025}}}});
  results.add("b", run("arm", "50 ms", scores_with(0.03)), {{"backend", {{"frame_duration", 0.05}}}});
  CHECK_THAT(results.table({}), !Contains("frame_duration"));
}

TEST_CASE("Rows stand in the order of their config") {
  Results results;
  int position = 0;
  for (const char* label : {"mine", "baseline", "another"}) {
    Json json = run("arm", label, scores_with(0.02));
    json["position"] = position++;
    results.add(std::to_string(9 - position), json);
  }
  const auto runs = results.find();
  CHECK(runs[0].label == "mine");
  CHECK(runs[1].label == "baseline");
  CHECK(runs[2].label == "another");
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
  Json lost = run("arm", "good", scores_with(0.030), "lost");
  lost["seed"] = 8;
  lost["status"]["reason"] = "nothing was seen for 1 s";
  results.add("d", lost);
  CHECK_THAT(results.table({}), Contains("Lost: good (seed 8): nothing was seen for 1 s."));
  CHECK_THAT(results.table({}), Contains("Without scores: bad: 2 tracks at 3.051 s, 15 needed.") &&
                                    Contains("Without scores: unscored: only 2 of the estimate's poses"));
}

TEST_CASE("CSV has the exact numbers under the keys of metrics.json") {
  Results results;
  results.add("a", run("arm, left", "say \"one\"", scores_with(0.0123456789)));
  const std::string csv = results.table({.format = TableFormat::csv, .metrics = {"ate.trans_m.rmse"}});
  CHECK(csv.substr(0, csv.find('\n')) ==
        "experiment,label,seed,key,folder,ate.trans_m.rmse,pairs,coverage,scale,status,trajectory,protocol");
  CHECK_THAT(csv, Contains("\n\"arm, left\",\"say \"\"one\"\"\",7,mine-0123456789," + results.folder.file("a") +
                           ",0.0123456789,100,1,"));
}

TEST_CASE("Every format says which trajectory is scored") {
  Results results;
  Json json = run("arm", "mine", scores_with(0.02));
  json["online"] = json["final"];
  results.add("a", json);
  for (const TableFormat format : {TableFormat::text, TableFormat::markdown, TableFormat::latex}) {
    CHECK_THAT(results.table({.format = format}), Contains("Final: the trajectory as estimated after"));
    CHECK_THAT(results.table({.format = format, .online = true}), Contains("Online: each pose as estimated"));
  }
  CHECK_THAT(results.table({.format = TableFormat::csv}),
             Contains(",status,trajectory,protocol\n") && Contains(",final,"));
  CHECK_THAT(results.table({.format = TableFormat::csv, .online = true}), Contains(",online,"));
}

TEST_CASE("LaTeX is a float for a page: few columns, booktabs' rules, a label, the protocol in a note") {
  Results results;
  results.add("a", run("arm_2", "asynchronous", scores_with(0.012)));
  results.add("b", run("arm_2", "bundle", scores_with(0.034)));
  const std::string latex = results.table({.format = TableFormat::latex});
  CHECK(line_with(latex, "ATE") ==
        "                 &         ATE [m] & ATE [deg] & RPE [m] & RPE [deg] & real-time factor \\\\");
  CHECK_THAT(line_with(latex, "asynchronous"), Contains("& \\textbf{0.0120} &"));
  CHECK_THAT(latex, Contains("\\begin{tabular}{lrrrrr}") && Contains("\\caption{arm\\_2}") &&
                        Contains("\\label{tab:arm_2}") && !Contains("\\hline"));
  const std::vector<std::string> order = {"\\begin{table}", "\\caption",        "\\label",      "\\begin{tabular}",
                                          "\\toprule",      "\\midrule",        "\\bottomrule", "\\end{tabular}",
                                          "\\footnotesize", "Protocol: Sim(3)", "\\end{table}"};
  std::size_t at = 0;
  for (const std::string& part : order) {
    INFO(part);
    at = latex.find(part, at);
    REQUIRE(at != std::string::npos);
  }
  CHECK(std::ranges::count(latex, '{') == std::ranges::count(latex, '}'));
  results.add("c", run("arm_2", "third", scores_with(0.034), "degraded"));
  CHECK_THAT(results.table({.format = TableFormat::latex}), Contains("& status ") && Contains("degraded at 3.25 s"));
  CHECK_THAT(results.table({.format = TableFormat::latex, .metrics = {"coverage"}}),
             Contains("covered [\\%]") && !Contains("ATE [m]"));
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
