#include "eval/segment_error.hpp"

#include "core/data/tum.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"
#include "eval/protocol.hpp"
#include "eval/scores.hpp"
#include "eval/testing/trajectories.hpp"

namespace evbench {
namespace {

using namespace testing;
using Catch::Matchers::ContainsSubstring;

/// Each value must agree to 1e-6 of its size.
void compare(const Statistics& ours, const Json& theirs) {
  const Json json = to_json(ours);
  for (const auto& [name, value] : theirs.items()) {
    INFO(name);
    CHECK(json.at(name).get<double>() == Approx(value.get<double>()).epsilon(1e-6).margin(0.0));
  }
}

void compare(const SegmentScores& ours, const Json& theirs) {
  compare(ours.trans_percent, theirs.at("trans_percent"));
  compare(ours.rot_deg_per_m, theirs.at("rot_deg_per_m"));
}

/// A camera that moves by 1 cm per pose along x, and an estimate that is a tenth too long.
std::vector<PosePair> too_long(int count) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < count; ++i) {
    const double x = 0.01 * i;
    const Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    pairs.push_back({0.1 * i, SE3{q, {x, 0.0, 0.0}}, SE3{q, {1.1 * x, 0.0, 0.0}}});
  }
  return pairs;
}

}  // namespace

TEST_CASE("Errors over sub-trajectories equal the reference values of segment_reference.py") {
  const std::string sequence = GENERATE("mvsec_flying1", "tumvie_desk2", "tumvie_mocap-6dof");
  const std::string rule = GENERATE("rpg", "kitti");
  const auto truth_path = data_file("trajectories/" + sequence + "/groundtruth.txt");
  const auto estimate_path = data_file("trajectories/" + sequence + "/estimate.txt");
  if (!truth_path || !estimate_path) return;
  INFO(sequence << " " << rule);
  const Json expected = parse_json(read_file(EVBENCH_EVAL_TESTING "/expected_segments.json")).at(sequence).at(rule);
  ScoreOptions options;
  options.segments = rule;
  if (rule == "kitti") options.segment_lengths = {0.5, 1.0, 2.0};
  const Scores scores = score(read_tum(*truth_path), read_tum(*estimate_path), options);
  compare(scores.all_segments, expected);
  REQUIRE(scores.by_length.size() == expected.at("by_length").size());
  for (std::size_t i = 0; i < scores.by_length.size(); ++i) {
    CHECK(scores.by_length[i].length_m == Approx(expected.at("by_length")[i].at("length_m").get<double>()));
    compare(scores.by_length[i], expected.at("by_length")[i]);
  }
}

TEST_CASE("An estimate that is a tenth too long has an error of 10 % in every sub-trajectory") {
  const auto pairs = too_long(101);
  const auto rpg = segment_errors(pairs, {.rule = SegmentRule::rpg}, 1.0);
  REQUIRE(rpg.size() == 5);
  CHECK(rpg[1].length_m == Approx(0.2));
  for (const SegmentErrors& errors : rpg) {
    for (const double error : errors.trans_percent) CHECK(error <= Approx(12.0));
    CHECK(errors.trans_percent.front() == Approx(10.0));
    CHECK(errors.rot_deg_per_m.front() == Approx(0.0).margin(1e-9));
  }
  const auto kitti = segment_errors(pairs, {.rule = SegmentRule::kitti, .lengths = {0.195}}, 1.0);
  REQUIRE(kitti.size() == 1);
  CHECK(kitti[0].trans_percent.size() == 9);  // from poses 0, 10, ..., 80, to the first one beyond
  CHECK(kitti[0].trans_percent.front() == Approx(10.0 * 0.2 / 0.195));
}

TEST_CASE("There are no sub-trajectories longer than the path") {
  const auto kitti = segment_errors(too_long(11), {.rule = SegmentRule::kitti}, 0.1);
  REQUIRE(kitti.size() == 8);
  CHECK(kitti[0].trans_percent.empty());
  CHECK(segment_errors(too_long(11), {.rule = SegmentRule::rpg, .unit = LengthUnit::percent}, 0.001).empty());
  CHECK(segment_errors(too_long(11), {}, 0.1).empty());
  CHECK_THROWS_WITH(segment_errors(too_long(11), {.rule = SegmentRule::rpg, .lengths = {0.0}}, 0.1),
                    ContainsSubstring("a segment's length is 0; expected a number above 0"));
}

TEST_CASE("Requested scores over sub-trajectories are in the protocol, in JSON and in the text") {
  const PoseTrajectory truth = sample(wavy_pose, 300, 0.01);
  ScoreOptions options;
  CHECK_FALSE(to_json(score(truth, disturbed(truth), options)).contains("segments"));
  options.segments = "rpg";
  const Scores scores = score(truth, disturbed(truth), options);
  const Json json = to_json(scores).at("segments");
  CHECK(json.at("unit") == "percent");
  CHECK(json.at("by_length").size() == 5);
  CHECK(json.at("trans_percent").at("mean").get<double>() > 0.0);
  CHECK_THAT(protocol(to_json(scores), "here"),
             ContainsSubstring("; segments by rpg_trajectory_evaluation's rule, 10, 20, 30, 40, 50 % of the path"));
  CHECK_THAT(describe(scores), ContainsSubstring(" m [%]") && ContainsSubstring(" m [deg/m]"));
  options.segment_lengths = {0.5};
  CHECK_THAT(protocol(to_json(score(truth, disturbed(truth), options)), "here"), ContainsSubstring("rule, 0.5 m"));
}

}  // namespace evbench
