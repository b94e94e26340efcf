#include "eval/scores.hpp"

#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "eval/protocol.hpp"
#include "eval/testing/trajectories.hpp"

namespace evbench {
namespace {

using namespace testing;
using Catch::Matchers::ContainsSubstring;

const Similarity kSimilarity = {0.4, {so3::exp({0.4, -1.2, 2.0}), {3.0, -1.0, 0.5}}};

ScoreOptions with(const Json& json) { return read_options<ScoreOptions>(json, "evaluation"); }

}  // namespace

TEST_CASE("Scores do not depend on the estimate's world frame and scale") {
  const PoseTrajectory truth = sample(wavy_pose, 300, 0.01);
  const PoseTrajectory estimate = disturbed(truth);
  const Scores here = score(truth, estimate);
  const Scores there = score(truth, seen_from(estimate, kSimilarity));
  CHECK(here.ate.trans_m.rmse > 0.001);
  CHECK(there.ate.trans_m.rmse == Approx(here.ate.trans_m.rmse).epsilon(1e-9));
  CHECK(there.ate.rot_deg.rmse == Approx(here.ate.rot_deg.rmse).epsilon(1e-9));
  CHECK(there.rpe.trans_m.rmse == Approx(here.rpe.trans_m.rmse).epsilon(1e-9));
  CHECK(there.rpe.rot_deg.rmse == Approx(here.rpe.rot_deg.rmse).epsilon(1e-9));
  CHECK(there.alignment.transform.scale == Approx(0.4 * here.alignment.transform.scale).epsilon(1e-9));
}

TEST_CASE("Each additional degree of freedom of the alignment makes the absolute error smaller") {
  const PoseTrajectory truth = sample(wavy_pose, 300, 0.01);
  const PoseTrajectory estimate = disturbed(seen_from(truth, {0.9, {so3::exp({0.1, 0.2, 0.3}), {0.1, 0.2, 0.3}}}));
  const auto rmse = [&](const char* alignment) {
    return score(truth, estimate, with({{"alignment", alignment}})).ate.trans_m.rmse;
  };
  CHECK(rmse("yaw") < rmse("none"));
  CHECK(rmse("se3") < rmse("yaw"));
  CHECK(rmse("sim3") < rmse("se3"));
}

TEST_CASE("An alignment on a part is applied to all") {
  const PoseTrajectory truth = sample(wavy_pose, 300, 0.01);
  std::vector<StampedPose> poses = seen_from(truth, kSimilarity).poses();
  for (StampedPose& pose : poses) {
    if (pose.t > 0.995) pose.T.p.x() += 1.0;  // the later part is displaced
  }
  const PoseTrajectory estimate(poses);
  for (const Json& part : {Json{{"align_first", 100}}, Json{{"align_range", {0.0, 0.995}}}}) {
    const Scores scores = score(truth, estimate, with(part));
    CHECK(scores.aligned_pairs == 100);
    CHECK(scores.pairs == 300);
    CHECK(scores.alignment.transform.scale == Approx(0.4).epsilon(1e-9));
    CHECK(scores.ate.trans_m.min < 1e-9);
    CHECK(scores.ate.trans_m.max == Approx(0.4).epsilon(1e-9));  // the metre, scaled
  }
}

TEST_CASE("The common rotation error of orientations on a nearly straight path can be excluded") {
  const auto wound = [](double t, double towards, double turned) {
    const double offset = 1e-3 * std::sin(20.0 * t);
    return SE3{so3::exp({0.0, 0.0, turned}), {t, offset * std::cos(towards), offset * std::sin(towards)}};
  };
  const auto truth = [&](double t) { return wound(t, 0.0, 0.0); };
  const auto estimate = [&](double t) { return wound(t, 0.5, t < 1.0 ? 0.01 : -0.01); };
  const Scores scores = score(sample(truth, 200), sample(estimate, 200));
  constexpr double kOneDegree = 3.14159265358979 / 180.0;
  CHECK(scores.ate.rot_deg.rmse > 0.49 / kOneDegree);  // determined by the small offsets of the positions
  CHECK(scores.ate.rot_centred_deg.rmse == Approx(0.01 / kOneDegree).epsilon(0.01));
}

TEST_CASE("The error in percent is of the ground truth's path through the compared poses") {
  const auto straight = [](double t) { return SE3{Eigen::Quaterniond::Identity(), {t, 0.0, 0.0}}; };
  const auto shifted = [](double t) { return SE3{Eigen::Quaterniond::Identity(), {t, 0.05, 0.0}}; };
  const Scores scores = score(sample(straight, 501), sample(shifted, 201), with({{"alignment", "none"}}));
  CHECK(scores.path_m == Approx(2.0));
  CHECK(scores.ate.trans_percent == Approx(2.5));
  CHECK(scores.coverage == Approx(0.4));
}

TEST_CASE("The same input gives identical scores") {
  const PoseTrajectory truth = sample(wavy_pose, 300, 0.01);
  const PoseTrajectory estimate = disturbed(truth);
  CHECK(dump_json(to_json(score(truth, estimate))) == dump_json(to_json(score(truth, estimate))));
}

TEST_CASE("Relative errors without any pair are null, not an error") {
  const PoseTrajectory truth = sample(wavy_pose, 20, 0.4);
  const Scores scores = score(truth, truth, with({{"rpe_delta", 0.1}}));
  const Json json = to_json(scores);
  CHECK(json.at("rpe").at("pairs") == 0);
  CHECK(json.at("rpe").at("trans_m").at("rmse").is_null());
  CHECK_THAT(describe(scores), ContainsSubstring("no pairs: no two poses are that far apart"));
}

TEST_CASE("A stationary camera is scored, with a note instead of a percentage") {
  const auto standing = [](double) { return SE3{}; };
  const Scores scores = score(sample(standing, 50), sample(standing, 50));
  CHECK(scores.ate.trans_m.rmse == 0.0);
  const Json json = to_json(scores);
  CHECK(json.at("ate").at("trans_percent").is_null());
  CHECK(json.at("alignment").at("note").get<std::string>().find("is stationary") != std::string::npos);
}

TEST_CASE("Scores are always printed with their protocol") {
  const PoseTrajectory truth = sample(wavy_pose, 300, 0.01);
  const Scores scores = score(truth, disturbed(truth), with({{"align_first", 50}, {"time_range", {0.5, 2.0}}}));
  CHECK(protocol(to_json(scores), "here") ==
        "Sim(3) alignment on the first 50 poses; nearest ground truth within 0.01 s, only 0.5 to 2 s; RPE over 0.1 "
        "seconds, all pairs (delta within 10 %)");
  const std::string text = describe(scores);
  for (const char* part :
       {"Sim(3) alignment", "within 0.01 s", "all pairs", "151 poses compared", "100.0 %", "scale "}) {
    CHECK_THAT(text, ContainsSubstring(part));
  }
  CHECK_THROWS_WITH(protocol(Json::object(), "x/metrics.json"), ContainsSubstring("x/metrics.json: the protocol"));
}

TEST_CASE("Contradictory options of an evaluation, and options out of range, are errors") {
  const PoseTrajectory truth = sample(wavy_pose, 30);
  CHECK_THROWS_WITH(with({{"alignment", "sim4"}}),
                    ContainsSubstring("evaluation: alignment: ") && ContainsSubstring("sim3"));
  CHECK_THROWS_WITH(with({{"tolerance", -1.0}}), ContainsSubstring("evaluation: tolerance: "));
  CHECK_THROWS_WITH(with({{"rpe_detla", 1.0}}), ContainsSubstring("did you mean \"rpe_delta\""));
  CHECK_THROWS_WITH(score(truth, truth, with({{"time_range", {2.0, 1.0}}})),
                    ContainsSubstring("time_range: is [2.0,1.0]; expected rising"));
  CHECK_THROWS_WITH(score(truth, truth, with({{"align_first", 5}, {"align_range", {0.0, 1.0}}})),
                    ContainsSubstring("two of align_first, align_range and align_seconds are given"));
  CHECK_THROWS_WITH(score(truth, truth, with({{"align_range", {5.0, 6.0}}})),
                    ContainsSubstring("0 pairs of poses to align on"));
  ScoreOptions unknown;
  unknown.alignment = "sim4";
  CHECK_THROWS_WITH(score(truth, truth, unknown), ContainsSubstring("unknown alignment \"sim4\""));
}

}  // namespace evbench
