#include "eval/find_runs.hpp"

#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "eval/testing/runs.hpp"

namespace evbench {
namespace {

using namespace testing;
using Catch::Matchers::ContainsSubstring;

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
  CHECK_THROWS_WITH(results.find(), ContainsSubstring("no metrics.json in it or below"));
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
  CHECK_THAT(message("{\"final\": "), ContainsSubstring("key/metrics.json: is not JSON"));
  CHECK_THAT(message("[1, 2]"), ContainsSubstring("expected a JSON object"));
  CHECK_THAT(message("{\"label\": \"a\"}"), ContainsSubstring("\"final\" is missing"));
  CHECK_THAT(message("{\"final\": null, \"causal\": null}"), ContainsSubstring("\"experiment\" is missing"));
}

TEST_CASE("Runs of a sweep, also those not run yet, are in its order, with their places on its axes") {
  Results results;
  results.add("batching/a", run("x", "old name", scores_with(0.1)));
  results.add("batching/b", run("x", "bundle", scores_with(0.2)));
  results.add("batching/gone", run("x", "no more of the sweep", scores_with(0.2)));
  const auto planned = [](const char* key, const char* label, const Json& axes) {
    return Json{{"key", key}, {"label", label}, {"axes", axes}};
  };
  const Json plan = {{"name", "batching"},
                     {"axes", Json::array()},
                     {"runs",
                      {planned("b", "bundle", {{"frame", "0.1"}, {"seed", "3"}}),
                       planned("c", "bundle", {{"frame", "0.2"}, {"seed", "3"}}),
                       planned("a", "asynchronous", {{"frame", "0.1"}, {"seed", "3"}}),
                       planned("a", "asynchronous", {{"frame", "0.2"}, {"seed", "3"}})}}};
  results.folder.write("batching/sweep.json", dump_json(plan));
  for (const char* folder : {"batching", "batching/", "batching/."}) {
    INFO(folder);
    const std::vector<RunRecord> own = find_runs(std::vector{results.folder.file(folder)});
    CHECK(std::ranges::count(own, true, &RunRecord::done) > 0);
  }
  const auto runs = results.find();
  REQUIRE(runs.size() == 4);
  CHECK(runs[0].key == "mine-0123456789");
  CHECK(runs[0].axes == RunAxes{{"frame", "0.1"}, {"seed", "3"}});
  CHECK(runs[0].experiment == "batching");
  CHECK(runs[1].key == "c");
  CHECK_FALSE(runs[1].done);
  CHECK_FALSE(runs[1].competes());
  CHECK(runs[1].seed == 3);
  CHECK(runs[2].label == "asynchronous");
  CHECK(runs[2].axes.front().second == "0.1");
  CHECK(runs[3].axes.front().second == "0.2");
  CHECK(runs[3].done);
}

TEST_CASE("A damaged plan of a sweep is an error with the place") {
  Results results;
  results.add("batching/a", run("x", "a", scores_with(0.1)));
  const auto message = [&](const std::string& plan) -> std::string {
    results.folder.write("batching/sweep.json", plan);
    try {
      results.find();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  CHECK_THAT(message("{"), ContainsSubstring("batching/sweep.json: is not JSON"));
  CHECK_THAT(message("{\"name\": \"x\"}"), ContainsSubstring("sweep.json: \"runs\" is missing"));
  CHECK_THAT(message("{\"name\": \"x\", \"runs\": [{\"key\": \"a\", \"label\": \"b\", \"axes\": {\"seed\": 1}}]}"),
             ContainsSubstring("sweep.json: runs.0.axes: \"seed\" is 1; expected text"));
}

}  // namespace evbench
