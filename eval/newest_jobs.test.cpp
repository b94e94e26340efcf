#include "eval/newest_jobs.hpp"

#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "eval/table.hpp"
#include "eval/testing/runs.hpp"

namespace evbench {
namespace {

using namespace testing;

/// A run of "mine" with its own job and this time of completion; "": not known.
void add_job(const Results& results, const std::string& key, const std::string& finished, double frame = 0.1,
             int seed = 1) {
  Json json = run("arm", "mine", scores_with(0.02));
  json["seed"] = seed;
  json["key"] = key;
  results.add(key, json,
              {{"seed", seed}, {"source", {{"type", "simulation"}}}, {"backend", {{"batch_duration", frame}}}});
  if (!finished.empty()) results.folder.write(key + "/manifest.json", dump_json({{"finished", finished}}));
}

std::vector<std::string> keys_left(const Results& results, std::size_t left_out) {
  std::vector<RunRecord> runs = results.find();
  CHECK(keep_newest_jobs(runs) == left_out);
  std::vector<std::string> keys;
  for (const RunRecord& run : runs) keys.push_back(run.key);
  std::ranges::sort(keys);
  return keys;
}

}  // namespace

TEST_CASE("Of several jobs of one label and config only the newest is kept") {
  Results results;
  add_job(results, "a-old", "2024-05-01T10:00:00.000Z");
  add_job(results, "b-new", "2024-05-01T10:00:00.001Z");
  add_job(results, "c-older", "2023-12-31T23:59:59.999Z");
  CHECK(keys_left(results, 2) == std::vector<std::string>{"b-new"});
  add_job(results, "d-other-setting", "2020-01-01T00:00:00.000Z", 0.2);
  add_job(results, "e-other-seed", "2020-01-01T00:00:00.000Z", 0.1, 2);
  CHECK(keys_left(results, 2) == std::vector<std::string>{"b-new", "d-other-setting", "e-other-seed"});
}

TEST_CASE("The time of a run of an older version is that of its file") {
  Results results;
  add_job(results, "a-now", "");
  add_job(results, "b-before", "2001-01-01T00:00:00.000Z");
  CHECK(keys_left(results, 1) == std::vector<std::string>{"a-now"});
}

TEST_CASE("The same job in two folders, and runs without a known config, are all kept") {
  Results results;
  add_job(results, "a", "2024-05-01T10:00:00.000Z");
  std::filesystem::copy(results.folder.file("a"), results.folder.file("copy"));
  Json json = run("arm", "mine", scores_with(0.02));
  for (const char* key : {"x", "y"}) {
    json["key"] = key;
    results.add(key, json);
  }
  CHECK(keys_left(results, 0).size() == 4);
}

}  // namespace evbench
