#include "eval/table.hpp"

#include <cstdlib>
#include <filesystem>

#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "eval/table_latex.hpp"
#include "eval/testing/runs.hpp"

namespace evbench {
namespace {

using namespace testing;
using Catch::Matchers::ContainsSubstring;

std::string text_of(const Results& results, const TableOptions& options) { return make_table(results.find(), options); }

}  // namespace

TEST_CASE("A table shows the protocol, and the best value of each column") {
  Results results;
  results.add("a", run("arm", "asynchronous", scores_with(0.012)));
  results.add("b", run("arm", "bundle", scores_with(0.034)));
  const std::string text = text_of(results, {});
  CHECK_THAT(line_with(text, "asynchronous"), ContainsSubstring("0.0120*"));
  CHECK_THAT(line_with(text, "bundle"), ContainsSubstring("0.0340") && !ContainsSubstring("0.0340*"));
  CHECK_THAT(text, ContainsSubstring("Experiment: arm.") && ContainsSubstring("\n*: the best of a column among ") &&
                       ContainsSubstring("Protocol: Sim(3) alignment on all poses; nearest ground "
                                         "truth within 0.01 s; RPE over 0.1 seconds, all pairs"));
  CHECK_THAT(text_of(results, {.format = TableFormat::markdown}),
             ContainsSubstring("**0.0120**") && ContainsSubstring("\nBold: the best of a column among "));
}

TEST_CASE("Only runs of one experiment and protocol that were not lost compete") {
  Results results;
  results.add("a", run("arm", "good", scores_with(0.020)));
  results.add("b", run("arm", "better but lost", scores_with(0.010), "lost"));
  results.add("c", run("arm", "worse", scores_with(0.030)));
  results.add("d", run("arm", "other protocol", scores_with(0.001, "se3")));
  results.add("e", run("poster", "other experiment", scores_with(0.002)));
  const std::string text = text_of(results, {});
  CHECK_THAT(line_with(text, "good"), ContainsSubstring("0.02000*"));
  CHECK_THAT(line_with(text, "better but lost"), ContainsSubstring("lost at 3.25 s") && !ContainsSubstring("0.01000*"));
  CHECK_THAT(line_with(text, "other protocol"), !ContainsSubstring("0.00100*"));
  CHECK_THAT(line_with(text, "other experiment"), ContainsSubstring("poster") && !ContainsSubstring("0.00200*"));
  CHECK_THAT(text, ContainsSubstring("Protocol 1: ") && ContainsSubstring("Protocol 2: ") &&
                       ContainsSubstring("do not compete"));
}

TEST_CASE("Runs compete only with those of the same seed and source") {
  Results results;
  for (const int seed : {1, 2}) {
    results.add_seed("good", seed, 0.01 * seed);
    results.add_seed("bad", seed, 0.04 * seed);
  }
  const std::string text = text_of(results, {.metrics = {"ate.trans_m.rmse"}});
  CHECK_THAT(text, ContainsSubstring("0.0100*") && ContainsSubstring("0.0200*") && !ContainsSubstring("0.0400*") &&
                       !ContainsSubstring("0.0800*"));
}

TEST_CASE("All numbers that runs have can be listed, with their headers, and each is a column") {
  Results results;
  results.add_seed("good", 1, 0.01);
  const std::string keys = list_metrics(results.find());
  CHECK_THAT(line_with(keys, "ate.trans_m.rmse"), ContainsSubstring("ATE [m]"));
  CHECK_THAT(text_of(results, {.metrics = {line_with(keys, "ate.trans_m.median")}}),
             ContainsSubstring("ate.trans_m.median"));
  CHECK_THROWS_WITH(
      text_of(results, {.metrics = {"foo"}}),
      ContainsSubstring("no run has the metric \"foo\"; the most similar of ") && ContainsSubstring("--list-metrics"));
}

TEST_CASE("A run without an estimate is a row without values") {
  Results results;
  results.add("a", run("arm", "good", scores_with(0.020)));
  results.add("b", run("arm", "bad", nullptr, "failed"));
  CHECK_THAT(line_with(text_of(results, {}), "bad"), ContainsSubstring(" - ") && ContainsSubstring("failed at 3.25 s"));
  CHECK_THROWS_WITH(text_of(results, {.causal = true}), "none of the 2 runs has causal scores");
}

TEST_CASE("Runs that could not be scored still make a table") {
  Results results;
  results.add("a", run("arm", "no ground truth", nullptr));
  CHECK_THAT(line_with(text_of(results, {}), "no ground truth"), ContainsSubstring("1.50") && ContainsSubstring("ok"));
  CHECK_THAT(text_of(results, {}),
             ContainsSubstring("No run has scores") && ContainsSubstring("no ground truth: not known"));
}

TEST_CASE("If columns are chosen, notes give pairs, coverage and scale") {
  Results results;
  results.add("a", run("arm", "one", scores_with(0.020)));
  results.add("b", run("arm", "two", scores_with(0.030)));
  const std::string text = text_of(results, {.metrics = {"rpe.trans_m.median", "peak_rss_mib"}});
  CHECK_THAT(text, ContainsSubstring("rpe.trans_m.median") && ContainsSubstring("memory [MiB]") &&
                       !ContainsSubstring("ATE [m]"));
  CHECK_THAT(text, ContainsSubstring("pairs 100 to 100; covered [%] 100.0 to 100.0; scale "));
  CHECK_THROWS_WITH(
      text_of(results, {.metrics = {"rpe.trans_m.meddian"}}),
      ContainsSubstring("no run has the metric \"rpe.trans_m.meddian\"") && ContainsSubstring("rpe.trans_m.median"));
}

TEST_CASE("Runs that differ only in their seed or options are distinguished") {
  Results results;
  const auto add = [&](const std::string& name, int seed, const std::string& key) {
    Json json = run("arm", "mine", scores_with(0.02));
    json["seed"] = seed;
    json["key"] = key;
    results.add(name, json);
  };
  add("a", 1, "mine-aa");
  CHECK_THAT(text_of(results, {}), !ContainsSubstring("seed") && !ContainsSubstring("mine-aa"));
  add("b", 2, "mine-bb");
  CHECK_THAT(text_of(results, {}), ContainsSubstring("seed") && !ContainsSubstring("mine-aa"));
  add("c", 2, "mine-cc");
  CHECK_THAT(text_of(results, {}),
             ContainsSubstring("key") && ContainsSubstring("mine-bb") && ContainsSubstring("mine-cc"));
}

TEST_CASE("Settings in which runs of one label differ are columns, in the order of their values") {
  Results results;
  int folders = 9;
  for (const double duration : {0.05, 0.1}) {
    for (const int seed : {2, 1}) {
      Json json = run("arm", "bundle_adjustment", scores_with(0.02));
      json["seed"] = seed;
      results.add(std::to_string(folders--), json,
                  {{"seed", seed},
                   {"source", {{"type", "simulation"}}},
                   {"backend", {{"type", "bundle_adjustment"}, {"batch_duration", duration}, {"label", "x"}}}});
    }
  }
  const std::string text = text_of(results, {});
  CHECK_THAT(line_with(text, "ATE [m]"),
             ContainsSubstring("backend.batch_duration") && ContainsSubstring("seed") && !ContainsSubstring("key"));
  CHECK_THAT(text, !ContainsSubstring("source.type") && !ContainsSubstring("backend.label"));
  const auto runs = results.find();
  CHECK(runs[0].seed == 1);
  CHECK(runs[1].seed == 2);
  CHECK(*find_setting(runs[1].settings, "backend.batch_duration") == 0.05);
  CHECK(*find_setting(runs[2].settings, "backend.batch_duration") == 0.1);
  CHECK_THAT(text_of(results, {.format = TableFormat::csv}),
             ContainsSubstring("experiment,label,backend.batch_duration,seed,key,folder,") &&
                 ContainsSubstring("\narm,bundle_adjustment,0.05,1,"));
}

TEST_CASE("Runs with different labels need no columns of settings") {
  Results results;
  results.add("a", run("arm", "25 ms", scores_with(0.02)), {{"backend", {{"batch_duration", 0.025}}}});
  results.add("b", run("arm", "50 ms", scores_with(0.03)), {{"backend", {{"batch_duration", 0.05}}}});
  CHECK_THAT(text_of(results, {}), !ContainsSubstring("batch_duration"));
}

TEST_CASE("Rows are in the order of their config") {
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

TEST_CASE("The times of front-end and back-end are columns, and every other time can be") {
  Results results;
  results.add("a", run("arm", "one", scores_with(0.020)));
  CHECK_THAT(line_with(text_of(results, {}), "ATE [m]"),
             ContainsSubstring("front-end [s]") && ContainsSubstring("back-end [s]"));
  CHECK_THAT(line_with(text_of(results, {}), "one"), ContainsSubstring(" 0.250") && ContainsSubstring(" 1.75"));
  CHECK_THAT(line_with(text_of(results, {.metrics = {"times.waiting_s", "times.harness_s", "data_s"}}), "one"),
             ContainsSubstring("0.500") && ContainsSubstring("0.125") && ContainsSubstring("3.00"));
  CHECK_THROWS_WITH(text_of(results, {.metrics = {"times.waitng_s"}}), ContainsSubstring("times.waiting_s"));
}

TEST_CASE("Notes give the reasons why runs have no scores") {
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
  CHECK_THAT(text_of(results, {}), ContainsSubstring("Lost: good (seed 8): nothing was seen for 1 s."));
  CHECK_THAT(text_of(results, {}), ContainsSubstring("Without scores: bad: 2 tracks at 3.051 s, 15 needed.") &&
                                       ContainsSubstring("Without scores: unscored: only 2 of the estimate's poses"));
}

TEST_CASE("A sweep's axes are columns, and its planned runs that are not done are rows") {
  Results results;
  results.add("batching/a", run("batching", "bundle", scores_with(0.02)));
  const auto planned = [](const char* key, const char* frame) {
    return Json{{"key", key}, {"label", "bundle"}, {"axes", {{"frame", frame}, {"seed", "7"}}}};
  };
  const Json plan = {
      {"name", "batching"}, {"axes", Json::array()}, {"runs", {planned("a", "0.1"), planned("b", "0.2")}}};
  results.folder.write("batching/sweep.json", dump_json(plan));
  const std::string text = text_of(results, {});
  CHECK_THAT(line_with(text, "ATE [m]"), ContainsSubstring("frame") && !ContainsSubstring("seed"));
  CHECK_THAT(line_with(text, "0.1 "), ContainsSubstring("0.02") && ContainsSubstring("ok"));
  CHECK_THAT(line_with(text, "0.2 "), ContainsSubstring("-") && ContainsSubstring("not run"));
  CHECK_THAT(text, ContainsSubstring("Not run yet: bundle (frame 0.2)."));
  CHECK_THAT(text_of(results, {.over = {"frame"}}), ContainsSubstring("1 of 1"));

  // A run that can't be read is also one of its runs.
  results.add("batching/b", std::string("{"));
  std::vector<std::string> unreadable;
  const std::vector<RunRecord> runs = find_runs(std::vector{results.folder.path()}, &unreadable);
  CHECK(unreadable.size() == 1);
  const std::string damaged = make_table(runs, {});
  CHECK_THAT(line_with(damaged, "0.2 "), ContainsSubstring("damaged"));
  CHECK_THAT(damaged, ContainsSubstring("Damaged: bundle (frame 0.2): ") && ContainsSubstring("is not JSON"));
  CHECK_THAT(make_table(runs, {.over = {"frame"}}), ContainsSubstring("1 of 2"));
}

TEST_CASE("The reason why a run broke off is in text tables and in CSV") {
  Results results;
  Json hung = run("arm", "hung", Json(), "failed"), crashed = hung;
  hung["status"] = {{"state", "failed"}, {"reason", "timeout after 60 s"}, {"time", 0.0}, {"complete", false}};
  crashed["label"] = "crashed";
  crashed["status"] = {
      {"state", "failed"}, {"reason", "error: " + std::string(80, 'x')}, {"time", 0.0}, {"complete", false}};
  results.add("a", hung);
  results.add("b", crashed);
  const std::string text = text_of(results, {});
  CHECK_THAT(line_with(text, "hung "), ContainsSubstring("timeout after 60 s"));
  CHECK_THAT(line_with(text, "crashed "),
             ContainsSubstring("failed") && !ContainsSubstring("xxx") && !ContainsSubstring("at 0.00 s"));
  CHECK_THAT(text_of(results, {.format = TableFormat::csv}), ContainsSubstring(",failed,timeout after 60 s,"));
  CHECK_THAT(text_of(results, {.format = TableFormat::long_csv}), ContainsSubstring(",failed,timeout after 60 s,"));
}

TEST_CASE("CSV has the exact numbers under the keys of metrics.json") {
  Results results;
  results.add("a", run("arm, left", "say \"one\"", scores_with(0.0123456789)));
  const std::string csv = text_of(results, {.format = TableFormat::csv, .metrics = {"ate.trans_m.rmse"}});
  CHECK(csv.substr(0, csv.find('\n')) ==
        "experiment,label,seed,key,folder,ate.trans_m.rmse,pairs,coverage,scale,status,reason,trajectory,protocol");
  CHECK_THAT(csv, ContainsSubstring("\n\"arm, left\",\"say \"\"one\"\"\",7,mine-0123456789," +
                                    results.folder.file("a") + ",0.0123456789,100,1,"));
}

TEST_CASE("Every format has the scored trajectory, final or causal") {
  Results results;
  Json json = run("arm", "mine", scores_with(0.02));
  json["causal"] = json["final"];
  results.add("a", json);
  for (const TableFormat format : {TableFormat::text, TableFormat::markdown, TableFormat::latex}) {
    CHECK_THAT(text_of(results, {.format = format}), ContainsSubstring("Final: the trajectory as estimated after"));
    CHECK_THAT(text_of(results, {.format = format, .causal = true}),
               ContainsSubstring("Causal: each pose as estimated"));
  }
  CHECK_THAT(text_of(results, {.format = TableFormat::csv}),
             ContainsSubstring(",status,reason,trajectory,protocol\n") && ContainsSubstring(",final,"));
  CHECK_THAT(text_of(results, {.format = TableFormat::csv, .causal = true}), ContainsSubstring(",causal,"));
}

TEST_CASE("LaTeX is a float for a column: few columns with short headers, a label, the protocol in the caption") {
  Results results;
  results.add("a", run("arm_2", "asynchronous", scores_with(0.012)));
  results.add("b", run("arm_2", "bundle", scores_with(0.134)));
  const std::string latex = text_of(results, {.format = TableFormat::latex});
  CHECK(line_with(latex, "{ATE [m]}") == "     & {ATE [m]} & {RPE [m]} & {RPE [deg]} & {RTF} \\\\");
  CHECK_THAT(line_with(latex, "asynchronous"), ContainsSubstring("asynchronous & \\bfseries 0.0120 & "));
  CHECK_THAT(latex, ContainsSubstring("\\begin{tabular}{lS[detect-weight, mode=text, table-format=1.4]S[") &&
                        ContainsSubstring("\\caption[{arm\\_2}]{arm\\_2.") && ContainsSubstring("\\label{tab:arm_2}") &&
                        ContainsSubstring("\\usepackage{booktabs, siunitx}") && ContainsSubstring("Bold: the best") &&
                        ContainsSubstring("RTF, the real-time factor: ") && !ContainsSubstring("\\hline") &&
                        !ContainsSubstring("*") && !ContainsSubstring(results.folder.path()));
  const std::vector<std::string> order = {"\\begin{table}",   "\\caption",   "Protocol: Sim(3)", "\\label",
                                          "\\begin{tabular}", "\\toprule",   "\\midrule",        "\\bottomrule",
                                          "\\end{tabular}",   "\\end{table}"};
  std::size_t at = 0;
  for (const std::string& part : order) {
    INFO(part);
    at = latex.find(part, at);
    REQUIRE(at != std::string::npos);
  }
  CHECK(std::ranges::count(latex, '{') == std::ranges::count(latex, '}'));
  results.add("c", run("arm_2", "third", scores_with(0.034), "degraded"));
  const std::string degraded = text_of(results, {.format = TableFormat::latex});
  CHECK_THAT(degraded, ContainsSubstring("& status ") && ContainsSubstring("& degraded \\\\") &&
                           !ContainsSubstring("Degraded: ") && !ContainsSubstring("3.25"));
  CHECK_THAT(text_of(results, {.format = TableFormat::latex, .metrics = {"coverage"}}),
             ContainsSubstring("{cov. [\\%]}") && !ContainsSubstring("{ATE [m]}"));
}

TEST_CASE("The body of a LaTeX table is its tabular, with the protocol as a comment") {
  Results results;
  results.add("a", run("arm", "one", scores_with(0.012)));
  results.add("b", run("arm", "two", nullptr, "lost"));
  const std::string body = text_of(results, {.format = TableFormat::latex, .layout = {.body = true}});
  CHECK(body.starts_with("% \\usepackage{booktabs, siunitx}\n"));
  CHECK_THAT(body, ContainsSubstring("\n% Protocol: Sim(3) alignment") && !ContainsSubstring("caption") &&
                       !ContainsSubstring("\\begin{table}") && ContainsSubstring("two & {--} & {--} & "));
  CHECK(body.ends_with("\\end{tabular}\n"));
}

TEST_CASE("LaTeX shortens the paths of compared files to the parts in which they differ") {
  std::vector<RunRecord> records;
  for (const char* path : {"/data/mine/a/final.tum", "/data/mine/b/final.tum"}) {
    RunRecord& record = records.emplace_back();
    record.experiment = "/data/truth/groundtruth.txt";
    record.label = path;
    record.final_scores = scores_with(0.02);
  }
  const std::string latex = make_table(records, {.format = TableFormat::latex});
  CHECK_THAT(latex, ContainsSubstring(" a/final.tum & ") && ContainsSubstring(" b/final.tum & ") &&
                        ContainsSubstring("\\label{tab:groundtruth.txt}") && !ContainsSubstring("/data"));
  CHECK_THAT(make_table(records, {.format = TableFormat::csv}), ContainsSubstring("/data/mine/a/final.tum"));
}

TEST_CASE("In LaTeX numbers are aligned by their decimal points, whatever else is in a column") {
  TextTable table;
  table.columns = {{"", false}, {"error"}, {"p"}, {"runs"}};
  table.rows = {{{"a_1"}, {"-0.125"}, {"1e-05"}, {"5 of 5"}},
                {{"b"}, {"12.5", true}, {"0.25"}, {"4 of 5"}},
                {{"c"}, {"fails"}, {"-"}, {"0 of 5"}}};
  const std::string latex = format_latex(table, true);
  CHECK_THAT(latex, ContainsSubstring("{lS[detect-weight, mode=text, table-format=-2.3]S[detect-weight, mode=text, "
                                      "table-format=1.2e-1]r}"));
  CHECK_THAT(latex, ContainsSubstring("a\\_1 & -0.125 & 1e-5 & 5 of 5") &&
                        ContainsSubstring("b & \\bfseries 12.5 & 0.25 & 4 of 5") &&
                        ContainsSubstring("c & {fails} & {--} & 0 of 5"));
}

TEST_CASE("pdflatex accepts LaTeX tables") {
  if (std::system("command -v pdflatex > /dev/null 2>&1") != 0) {  // NOLINT(cert-env33-c,concurrency-mt-unsafe)
    WARN("left out: pdflatex is not installed");
    return;
  }
  Results results;
  results.add("a", run("arm_2", "50 % [of] a_b & {c} #1 $x^2~\\y", scores_with(0.012)));
  results.add("b", run("arm_2", "lost", scores_with(0.134), "lost"));
  for (const bool body : {false, true}) {
    const std::string latex = text_of(results, {.format = TableFormat::latex, .layout = {.body = body}});
    results.folder.write(
        "t.tex", "\\documentclass[twocolumn]{article}\\usepackage{booktabs,siunitx}\\begin{document}\n" + latex +
                     "\\end{document}\n");
    const std::string command =
        "cd '" + results.folder.path() + "' && pdflatex -interaction=nonstopmode -halt-on-error t.tex > log.txt 2>&1";
    CHECK(std::system(command.c_str()) == 0);  // NOLINT(cert-env33-c,concurrency-mt-unsafe)
  }
}

TEST_CASE("Text leaves out the least important columns if they do not fit, and lists them") {
  Results results;
  results.add("a", run("arm", "asynchronous", scores_with(0.012)));
  results.add("b", run("arm", "bundle adjustment", scores_with(0.034)));
  const std::string all = text_of(results, {});
  CHECK_THAT(all, !ContainsSubstring("Left out"));
  for (const std::size_t width : {80, 100, 120}) {
    INFO(width);
    const std::string text = text_of(results, {.layout = {.width = width}});
    const std::string header = line_with(text, "ATE [m]");
    for (const char* name : {"asynchronous", "bundle adjustment", "ATE [m]"}) {
      CHECK(line_with(text, name).size() <= width);
    }
    CHECK_THAT(header, ContainsSubstring("RPE [m]") && ContainsSubstring("covered [%]") &&
                           ContainsSubstring("real-time factor") && ContainsSubstring("status"));
    CHECK_THAT(text, ContainsSubstring(fmt::format("Left out for a width of {}: ", width)) &&
                         ContainsSubstring("waiting [s] (evbench table --wide has all columns)"));
  }
  CHECK_THAT(line_with(text_of(results, {.layout = {.width = 120}}), "ATE [m]"), ContainsSubstring("RPE [deg]"));
  CHECK_THAT(text_of(results, {.metrics = {"ate.trans_m.rmse", "pairs", "scale"}, .layout = {.width = 20}}),
             ContainsSubstring("scale") && !ContainsSubstring("Left out"));
  CHECK(text_of(results, {.format = TableFormat::csv, .layout = {.width = 80}}) ==
        text_of(results, {.format = TableFormat::csv}));
}

TEST_CASE("The folder of a run is a column by request") {
  Results results;
  results.add("a", run("arm", "mine", scores_with(0.02)));
  const std::string folder = results.folder.file("a");
  CHECK_THAT(text_of(results, {}), !ContainsSubstring(folder));
  CHECK_THAT(line_with(text_of(results, {.folders = true}), "mine"), ContainsSubstring(folder));
  const std::string chosen = text_of(results, {.metrics = {"ate.trans_m.rmse", "key", "folder"}});
  CHECK_THAT(line_with(chosen, "mine "), ContainsSubstring("mine-0123456789") && ContainsSubstring(folder));
  CHECK_THROWS_WITH(text_of(results, {.metrics = {"folder"}, .over = {"seed"}}),
                    ContainsSubstring("\"folder\" is of one run"));
}

TEST_CASE("The status ok includes the missing part of the time") {
  const auto status = [](double coverage, double first) {
    Results results;
    Json json = run("arm", "mine", scores_with(0.02));
    json["range_s"] = {2.0, 12.0};
    json["final"]["coverage"] = coverage;
    json["final"]["span_s"] = {2.0 + first, 12.0};
    results.add("a", json);
    const std::string line = line_with(text_of(results, {}), "mine ");
    return line.substr(line.find("ok"));
  };
  CHECK(status(0.98, 0.1) == "ok");
  CHECK(status(0.73, 0.5) == "ok, covers 73 %");
  CHECK(status(0.95, 1.25) == "ok, from 3.25 s");
  CHECK(status(0.5, 1.25) == "ok, covers 50 % from 3.25 s");
  // Without ground truth it is determined by the estimate's own time.
  Results results;
  Json json = run("arm", "mine", nullptr);
  json["range_s"] = {0.0, 10.0};
  json["status"] = {
      {"state", "ok"}, {"segments", {{{"from", 3.0}, {"to", 10.0}, {"poses", 9}}}}, {"scored_segment", 1}};
  results.add("a", json);
  CHECK_THAT(line_with(text_of(results, {}), "mine "), ContainsSubstring("ok, covers 70 % from 3.00 s"));
  CHECK_THAT(text_of(results, {.format = TableFormat::csv}), ContainsSubstring(",ok,,final,"));
  CHECK_THAT(text_of(results, {.format = TableFormat::latex}), ContainsSubstring("ok, covers 70 \\% from 3.00 s"));
}

TEST_CASE("Characters with a meaning in LaTeX and Markdown are escaped") {
  CHECK(escape_latex("50 % of a_b & {c} #1 $x^2~\\y") ==
        "50 \\% of a\\_b \\& \\{c\\} \\#1 \\$x\\textasciicircum{}2\\textasciitilde{}\\textbackslash{}y");
  CHECK(escape_latex("[a]") == "{[}a]");
  Results results;
  results.add("a", run("arm", "a|b_c", scores_with(0.02)));
  CHECK_THAT(text_of(results, {.format = TableFormat::markdown}), ContainsSubstring("a\\|b\\_c"));
}

}  // namespace evbench
