#include "bench/run_index.hpp"

#include <filesystem>

#include "bench/testing/program.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "eval/testing/runs.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

TEST_CASE("The index of an experiment has a sorted line for each run, with the settings that differ") {
  const Results results;
  results.add_seed("bundle", 2, 0.2, 0.1);
  results.add_seed("bundle", 1, 0.1, 0.1);
  results.add_seed("bundle", 1, std::nullopt, 0.05);
  results.add("broken", std::string("{"));
  results.add("x.evbench.part", run("arm", "half", scores_with(0.1)));
  write_run_index(results.folder.path());
  const std::string index = read_file(results.folder.file("index.csv"));
  CHECK(index.starts_with(
      "experiment,label,backend.batch_duration,seed,key,folder,ate.trans_m.rmse,ate.rot_deg.rmse,rpe.trans_m.rmse,"
      "rpe.rot_deg.rmse,pairs,coverage,scale,status,reason,trajectory,protocol\n"
      "arm,bundle,0.05,1,bundle1-0.050000,bundle1-0.050000,,,,,,,,failed,"));
  CHECK_THAT(index, ContainsSubstring("\narm,bundle,0.1,1,bundle1-0.100000,bundle1-0.100000,0.1,") &&
                        !ContainsSubstring("half") && !ContainsSubstring("broken"));
  CHECK(index.find(",0.1,1,") < index.find(",0.1,2,"));
  CHECK(std::ranges::count(index, '\n') == 4);
  // The same runs, made in another order and in another folder, give an identical file.
  const Results others;
  others.add_seed("bundle", 1, std::nullopt, 0.05);
  others.add_seed("bundle", 1, 0.1, 0.1);
  others.add_seed("bundle", 2, 0.2, 0.1);
  write_run_index(others.folder.path());
  CHECK(read_file(others.folder.file("index.csv")) == index);
  std::filesystem::remove_all(others.folder.file("bundle1-0.050000"));
  std::filesystem::remove_all(others.folder.file("bundle1-0.100000"));
  std::filesystem::remove_all(others.folder.file("bundle2-0.100000"));
  write_run_index(others.folder.path());
  CHECK_FALSE(std::filesystem::exists(others.folder.file("index.csv")));
}

TEST_CASE("Every command that makes or scores runs updates the index", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_comparison()));
  REQUIRE(testing::evbench(folder, "run c.json --quiet").exit_code == 0);
  const std::string index = folder.file("results/short/index.csv"), by_run = read_file(index);
  CHECK(std::ranges::count(by_run, '\n') == 3);
  for (const std::string& run : runs_of(folder.file("results/short"))) {
    CHECK_THAT(by_run, ContainsSubstring("," + std::filesystem::path(run).filename().string() + ","));
  }
  REQUIRE(testing::evbench(folder, "sweep c.json --quiet --out swept").exit_code == 0);
  CHECK(read_file(folder.file("swept/short/index.csv")) == by_run);
  // Killed between the last run and its index: the next call writes it, though there is nothing to do.
  std::filesystem::remove(folder.file("swept/short/index.csv"));
  REQUIRE(testing::evbench(folder, "sweep c.json --quiet --out swept").exit_code == 0);
  CHECK(read_file(folder.file("swept/short/index.csv")) == by_run);
  REQUIRE(testing::evbench(folder, "score results --quiet --set evaluation.alignment=se3").exit_code == 0);
  CHECK_THAT(read_file(index), ContainsSubstring("SE(3) alignment") && !ContainsSubstring("Sim(3) alignment"));
}

TEST_CASE("Of a rebuilt plugin only the newest runs are used, with a remark, and --all includes the others", "[slow]") {
  const Results results;
  for (const char* name : {"old", "new"}) {
    for (int seed = 1; seed <= 2; ++seed) {
      Json json = run("arm", "mine", scores_with(name == std::string("old") ? 0.5 : 0.25));
      json["seed"] = seed;
      json["key"] = name + std::to_string(seed);
      results.add(json["key"], json,
                  {{"seed", seed},
                   {"source", {{"type", "simulation"}, {"motion", "arm"}}},
                   {"frontend", {{"type", "oracle"}}},
                   {"backend", {{"type", "mine"}}}});
      results.folder.write(json["key"].get<std::string>() + "/manifest.json",
                           dump_json({{"finished", name == std::string("old") ? "2024-01-01" : "2024-01-02"}}));
      results.add_seed("base", seed, 1.0);
    }
  }
  const auto use = [&](const std::string& arguments) { return testing::evbench(results.folder, arguments); };
  const Outcome table = use("table . --metrics ate.trans_m.rmse");
  CHECK_THAT(table.out, ContainsSubstring("0.250") && !ContainsSubstring("0.500"));
  CHECK_THAT(table.err,
             ContainsSubstring("remark: 2 older runs are left out") && ContainsSubstring("--all includes them"));
  CHECK_THAT(use("table . --metrics ate.trans_m.rmse --all").out,
             ContainsSubstring("0.500") && ContainsSubstring("old1"));
  CHECK(use("table . --over seed").exit_code == 0);
  CHECK(use("compare . --base base --metrics ate.trans_m.rmse").exit_code == 0);
  const Outcome refused = use("compare . --all");
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, ContainsSubstring("not the same job") && ContainsSubstring("--only"));
  CHECK_THAT(use("table . --only key=old1 --metrics ate.trans_m.rmse").out, ContainsSubstring("0.500"));
  CHECK_THAT(use("table . --only backend.type=mine --metrics ate.trans_m.rmse").out, !ContainsSubstring("base"));
  CHECK_THAT(use("table . --only bakend.type=mine").err, ContainsSubstring("runs do not differ in \"bakend.type\""));
  CHECK_THAT(use("table . --labels mine=Ours --labels base=BA").out,
             ContainsSubstring("Ours") && ContainsSubstring("BA") && !ContainsSubstring("mine "));
  CHECK_THAT(use("table . --labels mime=Ours").err, ContainsSubstring("did you mean \"mine\"?"));
}

TEST_CASE("A text table is as wide as COLUMNS, or 120 characters, and --wide has all columns, with the folder") {
  const Results results;
  results.add("a", run("arm", "mine", scores_with(0.02)));
  const auto header = [&](const std::string& before, const std::string& after) {
    return line_with(shell(results.folder, before + " \"$evbench\" table . " + after).out, "ATE [m]");
  };
  const std::string usual = header("env -u COLUMNS", ""), narrow = header("COLUMNS=70", "");
  CHECK((usual.size() > 90 && usual.size() <= 120));
  CHECK((narrow.size() > 50 && narrow.size() <= 70));
  CHECK(header("COLUMNS=none", "") == usual);
  CHECK_THAT(header("COLUMNS=70", "--wide"), ContainsSubstring("waiting [s]") && ContainsSubstring("folder"));
  CHECK_THAT(shell(results.folder, "COLUMNS=70 \"$evbench\" table . --format csv").out,
             ContainsSubstring("times.waiting_s") && ContainsSubstring(",folder,"));
}
