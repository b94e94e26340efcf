#include "eval/run_record.hpp"

#include <filesystem>

#include "core/data/causal_poses.hpp"
#include "core/data/relative_poses.hpp"
#include "core/data/tum.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"
#include "eval/score_run.hpp"
#include "eval/testing/trajectories.hpp"

namespace evbench {
namespace {

using namespace testing;
using Catch::Matchers::ContainsSubstring;

/// A record with all fields set.
RunRecord full_record() {
  RunRecord record;
  record.experiment = "arm";
  record.label = "mine, 25 ms";
  record.seed = 18446744073709551615U;
  record.key = "mine-0123456789";
  record.final_unscored = "no ground truth";
  record.causal_scores = {{"pairs", 3}, {"coverage", 1.0 / 3.0}};
  record.range = {0.1, 30.0};
  record.runtime_s = 1.0 / 7.0;
  record.data_s = 29.9;
  record.realtime_factor = *record.data_s / *record.runtime_s;
  record.times = {0.05, 0.1, 0.2, 0.3, 0.4, 1.0, 2.5, std::nullopt, StepTimes{1.5, 2.5, 4.0}};
  record.peak_rss_mib = 31.25;
  RunStatus status;
  status.status = {RunState::lost, "2 tracks, 15 needed", 3.051, {{1.0, 1.5, "8 tracks"}}};
  status.stationary = {{2.0, 2.5}};
  status.segments = {{0.2, 3.0, 281, 40}, {4.0, 30.0, 2601, 77}};
  status.scored = 2;
  status.complete = false;
  record.status = status;
  return record;
}

std::string message_of(const Json& metrics) {
  try {
    read_record(metrics, "m.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("A record is identical after reading and writing") {
  for (const RunRecord& record : {full_record(), RunRecord{}}) {
    const std::string text = dump_json(to_json(record), 2);
    CHECK(dump_json(to_json(read_record(parse_json(text), "m.json")), 2) == text);
  }
  const RunRecord read = read_record(to_json(full_record()), "m.json");
  CHECK(read.seed == 18446744073709551615U);
  CHECK(read.key == "mine-0123456789");
  CHECK(read.times->waiting == 0.3);
  CHECK_FALSE(read.times->frontend_ms);
  CHECK(read.times->backend_ms->p99 == 2.5);
  REQUIRE(read.status);
  CHECK(read.status->status.state == RunState::lost);
  CHECK(read.status->status.time == 3.051);
  CHECK(read.status->segments.at(1).landmarks == 77);
  CHECK(read.status->scored == 2);
  CHECK_FALSE(read.status->complete);
}

TEST_CASE("Times of steps are in milliseconds: median, 99th percentile and maximum") {
  std::vector<double> seconds(100, 0.002);
  seconds[7] = 0.05;
  seconds[8] = 0.01;
  const StepTimes times = step_times(seconds).value();
  CHECK(times.median == Approx(2.0));
  CHECK(times.p99 == Approx(10.4));  // numpy.percentile(..., 99)
  CHECK(times.max == Approx(50.0));
  CHECK_FALSE(step_times({}));
}

TEST_CASE("Keys that an older version did not write are unknown, and those of a newer version are skipped") {
  const RunRecord read = read_record(
      {{"experiment", "e"}, {"label", "l"}, {"final", nullptr}, {"causal", nullptr}, {"brand_new", 1}}, "m.json");
  CHECK_FALSE(read.seed);
  CHECK(read.key.empty());
  CHECK_FALSE(read.times);
  CHECK_FALSE(read.status);
}

TEST_CASE("A damaged metrics.json is an error with the file and the key") {
  const auto with = [](const char* pointer, const Json& value) {
    Json json = to_json(full_record());
    json[Json::json_pointer(pointer)] = value;
    return json;
  };
  CHECK(message_of(to_json(full_record())).empty());
  CHECK_THAT(message_of(with("/seed", -1)),
             ContainsSubstring("m.json: \"seed\" is -1; expected a whole number from 0 on"));
  CHECK_THAT(message_of(with("/key", 3)), ContainsSubstring("m.json: \"key\""));
  CHECK_THAT(message_of(with("/runtime_s", "long")),
             ContainsSubstring("m.json: \"runtime_s\" is \"long\"; expected a number"));
  CHECK_THAT(message_of(with("/times/backend_s", nullptr)),
             ContainsSubstring("m.json: times: \"backend_s\" is missing"));
  CHECK_THAT(message_of(with("/range_s", {1})), ContainsSubstring("m.json: \"range_s\" is [1]; expected two times"));
  CHECK_THAT(message_of(with("/status", 3)), ContainsSubstring("m.json: status: expected a JSON object"));
  CHECK_THAT(message_of(with("/status/state", "fine")),
             ContainsSubstring("\"state\" is \"fine\"; expected ok, degraded"));
  CHECK_THAT(message_of(with("/status/segments/1/from", "x")),
             ContainsSubstring("m.json: status: segments.1: \"from\""));
  CHECK_THAT(message_of(with("/status/complete", "yes")),
             ContainsSubstring("\"complete\" is \"yes\"; expected true or false"));
  CHECK_THAT(message_of(with("/final", 3)), ContainsSubstring("\"final\" is missing; expected scores or null"));
}

TEST_CASE("A run's folder is scored from its files within the run's range, or has a reason why it can't be") {
  const TemporaryFolder folder;
  const PoseTrajectory truth = sample(wavy_pose, 400, 0.01);
  folder.write("causal.tum", "");
  write_file(folder.file("final.tum"), format_tum(disturbed(truth)));
  RunRecord record = full_record();
  record.range = {1.0, 3.0};
  score_run(folder.path(), {}, record);
  CHECK(record.final_unscored == "no ground truth");

  write_file(folder.file("groundtruth.tum"), format_tum(truth));
  score_run(folder.path(), {}, record);
  CHECK(record.final_unscored.empty());
  CHECK(record.final_scores.at("association").at("time_range_s") == Json{1.0, 3.0});
  CHECK(record.final_scores.at("pairs") == 201);
  CHECK(record.causal_scores.is_null());
  CHECK(record.causal_unscored == "no trajectory: 2 tracks, 15 needed");

  score_run(folder.path(), {.alignment = "se3", .time_range = {2.0, 9.0}}, record);
  CHECK(record.final_scores.at("alignment").at("method") == "se3");
  CHECK(record.final_scores.at("association").at("time_range_s") == Json{2.0, 3.0});
  score_run(folder.path(), {.time_range = {5.0, 9.0}}, record);
  CHECK_THAT(record.final_unscored, ContainsSubstring("5 to 9 s, is outside of the run's, 1 to 3 s"));

  folder.write("final.tum", "1 2 3\n");
  CHECK_THROWS_WITH(score_run(folder.path(), {}, record), ContainsSubstring("final.tum:1: has 3 columns"));
  std::filesystem::remove(folder.file("final.tum"));
  CHECK_THROWS_WITH(score_run(folder.path(), {}, record), ContainsSubstring("final.tum: no such file"));
}

TEST_CASE("A run is scored at a latency by its published poses, and by its covariances, if there are such files") {
  const TemporaryFolder folder;
  const PoseTrajectory truth = sample(wavy_pose, 400, 0.01);
  write_file(folder.file("groundtruth.tum"), format_tum(truth));
  write_file(folder.file("final.tum"), format_tum(truth));
  write_file(folder.file("causal.tum"), format_tum(truth));
  RunRecord record = full_record();
  record.range = {0.0, 4.0};
  score_run(folder.path(), {.alignment = "none"}, record);
  CHECK_FALSE(record.causal_scores.contains("zero_latency"));
  CHECK(record.covariance.is_null());

  std::vector<CausalPose> published;  // batches of 0.1 s, known when they end
  for (int i = 0; i < 39; ++i) published.push_back({{0.05 + 0.1 * i, wavy_pose(0.05 + 0.1 * i)}, 0.1 + 0.1 * i});
  write_file(folder.file("causal_poses.txt"), format_causal_poses(published));
  write_file(folder.file("covariance.txt"),
             format_relative_poses(std::vector<RelativePose>{
                 {"over_1s", 1.0, 2.0, wavy_pose(1.0).inverse() * wavy_pose(2.0), Matrix6::Identity()}}));
  score_run(folder.path(), {.alignment = "none", .latency = 0.3}, record);
  const auto ate = [&](const char* latency) {
    return record.causal_scores.at(latency).at("ate").at("trans_m").at("rmse").get<double>();
  };
  CHECK(record.causal_scores.at("delay_s").at("median").get<double>() == Approx(0.05));
  CHECK(record.causal_scores.at("delay_s").at("max").get<double>() == Approx(0.05));
  CHECK(ate("zero_latency") > 0.005);
  CHECK(ate("equal_latency") < 0.3 * ate("zero_latency"));
  CHECK(record.causal_scores.at("equal_latency").at("latency_s") == 0.3);
  CHECK(record.covariance.at("over_1s").at("n") == 1);
  CHECK(record.covariance.at("over_1s").at("within_1_sigma") == 1.0);
  CHECK(dump_json(to_json(read_record(to_json(record), "m"))) == dump_json(to_json(record)));

  folder.write("causal_poses.txt", "1 2 3\n");
  CHECK_THROWS_WITH(score_run(folder.path(), {}, record), ContainsSubstring("causal_poses.txt:1: has 3 columns"));
}

}  // namespace evbench
