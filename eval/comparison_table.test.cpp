#include "eval/comparison_table.hpp"

#include <fstream>

#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "eval/methods.hpp"
#include "eval/paired_comparison.hpp"
#include "eval/testing/runs.hpp"

namespace evbench {
namespace {

using namespace testing;
using Catch::Matchers::ContainsSubstring;

/// Eight seeds of "base", of "half" with half its error, and of "same" with an error near it.
struct Compared : Results {
  Compared() {
    for (int seed = 1; seed <= 8; ++seed) {
      add_seed("base", seed, 0.02 + 0.001 * seed);
      add_seed("half", seed, 0.01 + 0.0005 * seed);
      add_seed("same", seed, (0.02 + 0.001 * seed) * (seed % 2 == 0 ? 1.01 : 0.99));
    }
  }
  std::string table(ComparisonOptions options = {}) const {
    if (options.metrics.empty()) options.metrics = {"ate.trans_m.rmse"};
    return make_comparison_table(find(), options);
  }
};

}  // namespace

TEST_CASE("Back-ends are compared pair by pair: ratio, interval, p, correction, effect") {
  const Compared results;
  const std::string text = results.table();
  CHECK_THAT(line_with(text, "half "), ContainsSubstring(" 8 ") && ContainsSubstring("0.5* [0.5, 0.5]") &&
                                           ContainsSubstring("0.0078") && ContainsSubstring("0.016") &&
                                           ContainsSubstring("-1.00"));
  CHECK_THAT(line_with(text, "same "), ContainsSubstring("[0.99, 1.01]") && !ContainsSubstring("*"));
  CHECK_THAT(text, ContainsSubstring("Compared with: base.") && ContainsSubstring("not known of 16") &&
                       ContainsSubstring("Protocol: Sim(3)"));
  CHECK(results.table() == text);
  CHECK_THAT(results.table({.base = "half"}),
             ContainsSubstring("Compared with: half.") && ContainsSubstring("2 [2, 2]"));
  CHECK_THAT(
      results.table({.format = TableFormat::csv}),
      ContainsSubstring("method,metric,pairs,failed,base failed,ratio,from,to,better in,p,\"p, Holm\",effect\n") &&
          ContainsSubstring("half,ate.trans_m.rmse,8,0,0,0.5"));
}

TEST_CASE("A note says that there are too few pairs for significance, and how many are needed") {
  Results results;
  for (int seed = 1; seed <= 5; ++seed) {
    for (const char* label : {"a", "b", "c"}) results.add_seed(label, seed, 0.01 * seed);
  }
  CHECK_THAT(make_comparison_table(results.find(), {}),
             ContainsSubstring("With 5 pairs and 2 comparisons nothing can reach that: it takes 7 pairs."));
  CHECK_THAT(Compared().table(), !ContainsSubstring("nothing can reach that"));
}

TEST_CASE("Pairs with identical observations are counted") {
  const Compared results;
  int n = 0;
  for (const RunRecord& run : results.find()) {
    const std::string tracks = run.label == "half" ? std::to_string(n++) : fmt::format("of seed {}", *run.seed);
    std::ofstream(run.folder + "/manifest.json") << dump_json({{"tracks_sha256", tracks}});
  }
  CHECK_THAT(results.table(), ContainsSubstring("Observations were identical in 8 of 16 pairs."));
}

TEST_CASE("Failures count in comparisons, and are shown") {
  Compared results;
  results.add_seed("base", 9, 0.03);
  results.add_seed("half", 9, std::nullopt);
  CHECK_THAT(line_with(results.table(), "half "),
             ContainsSubstring(" 9 ") && ContainsSubstring(" 1 ") && ContainsSubstring("0.5"));
}

TEST_CASE("Settings that differ on the same data are part of a method's name") {
  Results results;
  for (const double frame : {0.1, 0.2}) {
    for (int seed = 1; seed <= 3; ++seed) results.add_seed("bundle", seed, frame, frame);
  }
  const std::vector<RunRecord> runs = results.find();
  const std::vector<RunNumbers> numbers = numbers_of(runs, false);
  const auto methods = methods_of(numbers, run_columns(runs), number_data(numbers));
  REQUIRE(methods.size() == 2);
  CHECK(methods[0].name == "bundle, backend.batch_duration 0.1");
  CHECK(methods[1].runs.size() == 3);
  CHECK_THAT(make_comparison_table(runs, {}),
             ContainsSubstring("bundle, backend.batch_duration 0.2") && ContainsSubstring("2 [2, 2]"));
}

TEST_CASE("Front-ends are compared on the same source and seed where that is asked for") {
  const Results results;
  for (int seed = 1; seed <= 3; ++seed) {
    for (const auto& [tracks, ate] : {std::pair{50, 0.1}, {100, 0.05}}) {
      Json json = run("arm", "estimate", scores_with(ate));
      json["seed"] = seed;
      json["key"] = std::to_string(tracks) + "-" + std::to_string(seed);
      results.add(json["key"].get<std::string>(), json,
                  {{"seed", seed},
                   {"source", {{"type", "simulation"}}},
                   {"frontend", {{"type", "haste"}, {"tracks", tracks}}},
                   {"backend", {{"type", "estimate"}}}});
    }
  }
  CHECK_THROWS_WITH(make_comparison_table(results.find(), {}), ContainsSubstring("--front-ends compares front-ends"));
  const std::string text = make_comparison_table(results.find(), {.metrics = {"ate.trans_m.rmse"}, .front_ends = true});
  CHECK_THAT(line_with(text, "estimate, frontend.tracks 100 "), ContainsSubstring("0.5 [0.5, 0.5]"));
  CHECK_THAT(text,
             ContainsSubstring("Compared with: estimate, frontend.tracks 50. Pairs are runs of the same source and "
                               "seed."));
}

TEST_CASE("Runs that can't be compared are an error that says what is expected") {
  const Compared results;
  CHECK_THROWS_WITH(results.table({.base = "bas"}), "there is no method \"bas\"; did you mean \"base\"?");
  CHECK_THROWS_WITH(results.table({.metrics = {"coverage"}}),
                    ContainsSubstring("\"coverage\" can't be compared: neither lower nor higher is better"));
  CHECK_THROWS_WITH(results.table({.metrics = {"ate.tans_m.rmse"}}),
                    ContainsSubstring("did you mean \"ate.trans_m.rmse\"?"));
  Results one;
  one.add_seed("base", 1, 0.1);
  CHECK_THROWS_WITH(make_comparison_table(one.find(), {}),
                    ContainsSubstring("all runs with the same front-end are of one method"));
  one.add_seed("other", 2, 0.1);
  CHECK_THROWS_WITH(make_comparison_table(one.find(), {}),
                    ContainsSubstring("expected the same source, front-end and seed"));
}

}  // namespace evbench
