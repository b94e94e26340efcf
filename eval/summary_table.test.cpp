#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "eval/table.hpp"
#include "eval/testing/runs.hpp"

namespace evbench {
namespace {

using namespace testing;
using Catch::Matchers::ContainsSubstring;

std::string table(const Results& results, TableOptions options = {}) {
  options.over = {"seed"};
  if (options.metrics.empty()) options.metrics = {"ate.trans_m.rmse"};
  return make_table(results.find(), options);
}

/// Results over a number of seeds: of "good" 0.010, 0.011, ...; of "bad" twice that.
void add_seeds(const Results& results, int seeds) {
  for (int seed = 1; seed <= seeds; ++seed) {
    results.add_seed("good", seed, 0.009 + 0.001 * seed);
    results.add_seed("bad", seed, 0.018 + 0.002 * seed);
  }
}

}  // namespace

TEST_CASE("Over seeds a row has median and quartiles, and the number of successful runs") {
  Results results;
  add_seeds(results, 5);
  const std::string text = table(results);
  CHECK_THAT(line_with(text, "good "),
             ContainsSubstring("5 of 5") && ContainsSubstring("0.0120") && ContainsSubstring("[0.0110, 0.0130]"));
  CHECK_THAT(line_with(text, "bad "), ContainsSubstring("0.0240") && ContainsSubstring("[0.0220, 0.0260]"));
  CHECK_THAT(line_with(text, "ATE [m]"), !ContainsSubstring("seed") && !ContainsSubstring("key"));
  CHECK_THAT(text, ContainsSubstring("over seed (5 values)") && ContainsSubstring("Protocol: Sim(3)"));
}

TEST_CASE("By a column, rows count the runs that follow the ground truth, and those that are off with status ok") {
  Results results;
  const auto add = [&](int seed, const std::string& motion, double percent, double coverage, const std::string& state) {
    Json json = run("arm", "mine", scores_with(0.01), state);
    json["final"]["ate"]["trans_percent"] = percent;
    json["final"]["coverage"] = coverage;
    json["seed"] = seed;
    json["key"] = "mine" + std::to_string(seed);
    results.add(json["key"].get<std::string>(), json,
                {{"seed", seed},
                 {"source", {{"type", "simulation"}, {"motion", motion}}},
                 {"frontend", {{"type", "oracle"}}},
                 {"backend", {{"type", "mine"}}}});
  };
  add(1, "arm", 0.5, 1.0, "ok");
  add(2, "arm", 0.9, 0.95, "degraded");
  add(3, "arm", 0.4, 0.8, "ok");  // covers too little
  add(4, "arm", 3.0, 1.0, "ok");  // a false ok
  add(5, "hand", 3.0, 1.0, "degraded");
  add(6, "hand", 0.3, 1.0, "lost");
  TableOptions options;
  options.metrics = {"ate.trans_m.rmse"};
  options.by = {"source.motion"};
  const std::string text = make_table(results.find(), options);
  CHECK_THAT(line_with(text, "arm "),
             ContainsSubstring("50 % [15, 85]") && ContainsSubstring("0.70") && ContainsSubstring("3.00"));
  CHECK_THAT(line_with(text, "hand "), ContainsSubstring("0 % [0, 66]") && ContainsSubstring("fails"));
  CHECK_THAT(text, ContainsSubstring("within 1 %") && ContainsSubstring("false ok") && ContainsSubstring("over seed"));
  options.format = TableFormat::csv;
  const std::string csv = make_table(results.find(), options);
  CHECK_THAT(csv, ContainsSubstring("within,within.low,within.high,success.ate.trans_percent.median"));
  options.success = 4.0;
  options.format = TableFormat::text;
  CHECK_THAT(line_with(make_table(results.find(), options), "arm "), ContainsSubstring("75 %"));
  options.over = {"seed"};
  CHECK_THROWS_WITH(make_table(results.find(), options), ContainsSubstring("expected one of them"));
  options.by.clear();
  options.over.clear();
  CHECK_THROWS_WITH(make_table(results.find(), options), ContainsSubstring("expected --by or --over"));
  options.by = {"sede"};
  CHECK_THROWS_WITH(make_table(results.find(), options), ContainsSubstring("runs do not differ in \"sede\""));
}

TEST_CASE("Failed runs count as worse than all others, and are shown") {
  Results results;
  add_seeds(results, 3);
  results.add_seed("good", 4, std::nullopt);
  results.add_seed("bad", 4, std::nullopt);
  results.add_seed("bad", 5, std::nullopt);
  results.add_seed("bad", 6, std::nullopt);
  const std::string text = table(results);
  CHECK_THAT(line_with(text, "good "),
             ContainsSubstring("3 of 4") && ContainsSubstring("0.0115") && ContainsSubstring(", fails]"));
  CHECK_THAT(line_with(text, "bad "),
             ContainsSubstring("3 of 6") && ContainsSubstring("fails") && ContainsSubstring("[0.0225, fails]"));
  CHECK_THAT(text, ContainsSubstring("Without scores: bad (seed 4)") && ContainsSubstring("fails."));
  const std::string csv = table(results, {.format = TableFormat::csv});
  CHECK_THAT(csv, ContainsSubstring("label,runs,succeeded,ate.trans_m.rmse.lower,ate.trans_m.rmse.median") &&
                      ContainsSubstring("arm,bad,6,3,0.0225,inf,inf"));
}

TEST_CASE("Only values that differ significantly from all other rows are bold") {
  Results few, many;
  add_seeds(few, 5);
  add_seeds(many, 8);
  CHECK_THAT(line_with(table(few), "good "), !ContainsSubstring("*"));
  CHECK_THAT(table(few), ContainsSubstring("With 5 pairs and 1 comparison nothing can reach that: it takes 6 pairs."));
  CHECK_THAT(line_with(table(many), "good "), ContainsSubstring("0.0135*"));
  CHECK_THAT(line_with(table(many), "bad "), !ContainsSubstring("*"));
  CHECK_THAT(table(many, {.format = TableFormat::markdown}), ContainsSubstring("**0.0135** [0.0118, 0.0152]"));
  CHECK_THAT(table(many, {.format = TableFormat::latex}),
             ContainsSubstring("\\multicolumn{2}{c}{ATE [m]}") &&
                 ContainsSubstring("& \\bfseries 0.0135 & {\\scriptsize {[}0.0118, 0.0152]} ") &&
                 ContainsSubstring("table-format=1.4]@{\\,}l}") && !ContainsSubstring("*"));
  // Another sequence has a best row of its own, and pairs of its own.
  for (int seed = 1; seed <= 6; ++seed) {
    many.add_seed("good on hard", seed, 0.09 + 0.01 * seed, 0.1, "hard");
    many.add_seed("bad on hard", seed, 0.18 + 0.02 * seed, 0.1, "hard");
  }
  CHECK_THAT(line_with(table(many), "good  "), ContainsSubstring("0.0135*"));
  CHECK_THAT(line_with(table(many), "good on hard "), ContainsSubstring("0.1250*"));
  CHECK_THAT(table(many), ContainsSubstring("better than every other row of the same data") &&
                              !ContainsSubstring("nothing can reach"));
  for (int seed = 1; seed <= 8; ++seed) many.add_seed("as good", seed, 0.009 + 0.001 * seed);
  CHECK_THAT(line_with(table(many), "good "), !ContainsSubstring("*"));  // better than one of two
}

TEST_CASE("Settings that vary distinguish rows, or rows are summarised over them by request") {
  Results results;
  for (const int seed : {1, 2, 3}) {
    for (const double frame : {0.1, 0.2}) results.add_seed("bundle", seed, frame * seed, frame);
  }
  const auto runs = results.find();
  const std::string text = table(results);
  CHECK_THAT(line_with(text, "ATE [m]"), ContainsSubstring("backend.batch_duration"));
  CHECK_THAT(text, ContainsSubstring("0.200 [0.150, 0.250]") && ContainsSubstring("0.400 [0.300, 0.500]"));
  TableOptions options{.metrics = {"ate.trans_m.rmse"}, .over = {"seed", "backend.batch_duration"}};
  CHECK_THAT(make_table(runs, options), ContainsSubstring("6 of 6") && ContainsSubstring("0.250 [0.200, 0.375]"));
  options.over = {"seeds"};
  CHECK_THROWS_WITH(make_table(runs, options),
                    ContainsSubstring("runs do not differ in \"seeds\"; did you mean \"seed\"?"));
}

TEST_CASE("The same job in two folders counts once, and two jobs of the same place are an error") {
  Results results;
  add_seeds(results, 3);
  Json copy = run("arm", "good", scores_with(0.010));
  copy["seed"] = 1;
  copy["key"] = "good1-" + std::to_string(0.1);
  const Json config = {{"seed", 1},
                       {"source", {{"type", "simulation"}, {"motion", "arm"}}},
                       {"frontend", {{"type", "oracle"}}},
                       {"backend", {{"type", "good"}, {"batch_duration", 0.1}}}};
  results.add("copy", copy, config);
  CHECK_THAT(line_with(table(results), "good "), ContainsSubstring("3 of 3"));
  copy["key"] = "another";
  results.add("copy", copy, config);
  CHECK_THROWS_WITH(table(results),
                    ContainsSubstring("/copy") && ContainsSubstring("are both \"good\", seed 1, and not the same job"));
}

TEST_CASE("The long format has a line per run and metric, with the settings as columns") {
  Results results;
  results.add_seed("bundle", 1, 0.5, 0.1);
  results.add_seed("bundle", 2, std::nullopt, 0.2);
  const std::string csv =
      make_table(results.find(), {.format = TableFormat::long_csv, .metrics = {"ate.trans_m.rmse", "runtime_s"}});
  CHECK(csv.substr(0, csv.find('\n')) ==
        "experiment,label,backend.batch_duration,seed,key,folder,status,reason,trajectory,protocol,metric,value");
  CHECK(std::ranges::count(csv, '\n') == 5);
  CHECK_THAT(csv, ContainsSubstring("arm,bundle,0.1,1,") && ContainsSubstring(",ate.trans_m.rmse,0.5\n"));
  CHECK_THAT(csv, ContainsSubstring(",failed,,final,,ate.trans_m.rmse,\n") && ContainsSubstring(",runtime_s,2\n"));
  CHECK_THAT(make_table(results.find(), {.format = TableFormat::long_csv}),
             ContainsSubstring(",peak_rss_mib,30\n") && ContainsSubstring(",times.backend_s,1.75\n"));
}

}  // namespace evbench
