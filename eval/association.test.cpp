#include "eval/association.hpp"

#include "core/testing/catch2.hpp"
#include "eval/testing/trajectories.hpp"

namespace evbench {
namespace {

using Catch::Matchers::ContainsSubstring;
using testing::sample;
using testing::wavy_pose;

std::vector<double> times(double from, double to, double step) {
  std::vector<double> result;
  for (int i = 0; from + i * step <= to + 1e-9; ++i) result.push_back(from + i * step);
  return result;
}

std::vector<double> joined(std::vector<double> a, const std::vector<double>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace

TEST_CASE("Nearest association takes the pose nearest in time and drops poses without one") {
  const PoseTrajectory truth = sample(wavy_pose, 101, 0.1);
  const PoseTrajectory estimate = sample(wavy_pose, 20, 0.517, -1.0);
  const Association found = associate(truth, estimate, {.tolerance = 0.03});
  REQUIRE(found.pairs.size() >= 3);
  for (const PosePair& pair : found.pairs) {
    const double nearest = 0.1 * std::round(pair.t / 0.1);
    CHECK(std::abs(pair.t - nearest) <= 0.03 + 1e-12);
    CHECK((pair.ground_truth.p - wavy_pose(nearest).p).norm() < 1e-9);
    CHECK((pair.estimate.p - wavy_pose(pair.t).p).norm() < 1e-12);
  }
}

TEST_CASE("The trajectory with fewer poses leads the nearest association") {
  const PoseTrajectory coarse = sample(wavy_pose, 11, 0.1);
  const PoseTrajectory fine = sample(wavy_pose, 101, 0.01);
  CHECK(associate(coarse, fine, {}).pairs.size() == 11);
  CHECK(associate(fine, coarse, {}).pairs.size() == 11);
}

TEST_CASE("Interpolated ground truth is at the estimate's own times") {
  const auto straight = [](double t) { return SE3{so3::exp({0.0, 0.0, t}), {2.0 * t, 0.0, 0.0}}; };
  const PoseTrajectory truth = sample(straight, 101, 0.01);
  const PoseTrajectory estimate = sample(straight, 30, 0.0333, -0.1);
  const Association found = associate(truth, estimate, {.mode = AssociationMode::interpolated, .tolerance = 0.005});
  for (const PosePair& pair : found.pairs) {
    CHECK((pair.ground_truth.p - pair.estimate.p).norm() < 1e-12);
    CHECK(pair.ground_truth.q.angularDistance(pair.estimate.q) < 1e-7);
    CHECK(pair.t >= 0.0);
  }
  CHECK(found.pairs.size() == 26);  // those before the ground truth begins have none
}

TEST_CASE("Ground truth is not interpolated across a gap that is longer than the tolerance allows") {
  std::vector<StampedPose> poses;
  for (int i = 0; i <= 200; ++i) {
    if (i <= 50 || i >= 150) poses.push_back({0.01 * i, wavy_pose(0.01 * i)});
  }
  const PoseTrajectory truth(poses);
  const PoseTrajectory estimate = sample(wavy_pose, 200, 0.01, 0.005);
  for (const PosePair& pair : associate(truth, estimate, {.mode = AssociationMode::interpolated}).pairs) {
    CHECK((pair.t <= 0.51 || pair.t >= 1.49));
  }
}

TEST_CASE("A time offset and a time range select the pairs") {
  const PoseTrajectory truth = sample(wavy_pose, 101, 0.01);
  std::vector<StampedPose> late;
  for (const StampedPose& pose : truth.poses()) late.push_back({pose.t + 5.0, pose.T});
  const Association found =
      associate(truth, PoseTrajectory(late), {.tolerance = 0.001, .time_offset = -5.0, .range = {0.295, 0.605}});
  CHECK(found.pairs.size() == 31);
  CHECK(found.coverage == Approx(1.0));
  for (const PosePair& pair : found.pairs) CHECK((pair.ground_truth.p - pair.estimate.p).norm() == 0.0);
}

TEST_CASE("Too few pairs are an error with the probable reason") {
  const PoseTrajectory truth = sample(wavy_pose, 101, 0.01);
  const auto stretched = [&](double factor, double offset) {
    std::vector<StampedPose> poses;
    for (const StampedPose& pose : truth.poses()) poses.push_back({factor * pose.t + offset, pose.T});
    return PoseTrajectory(poses);
  };
  CHECK_THROWS_WITH(associate(truth, stretched(1e6, 1e9), {}),
                    ContainsSubstring("none of the estimate's poses") && ContainsSubstring("look like microseconds"));
  CHECK_THROWS_WITH(associate(stretched(1e9, 0.5e9), truth, {}),
                    ContainsSubstring("ground truth's times look like nanoseconds"));
  CHECK_THROWS_WITH(associate(truth, stretched(1.0, 1000.0), {}),
                    ContainsSubstring("don't overlap") && ContainsSubstring("offset of -1000.000000 s"));
  CHECK_THROWS_WITH(associate(truth, stretched(1.0, 0.995), {}),
                    ContainsSubstring("only 2") && ContainsSubstring("expected at least 3"));
  CHECK_THROWS_WITH(associate(truth, stretched(1.0, 0.005), {.tolerance = 0.001}),
                    ContainsSubstring("larger tolerance"));
  CHECK_THROWS_WITH(associate(truth, truth, {.range = {5.0, 6.0}}),
                    ContainsSubstring("no ground truth in the time range 5 to 6"));
}

TEST_CASE("An estimate of few poses, or of a short time, is not reported as a wrong unit of time") {
  const PoseTrajectory truth = sample(wavy_pose, 1001, 0.01);
  const auto message = [&](const PoseTrajectory& ground_truth, const PoseTrajectory& estimate) -> std::string {
    try {
      associate(ground_truth, estimate, {.tolerance = 0.001});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  CHECK(message(truth, sample(wavy_pose, 2, 0.01)) == "the estimate has 2 poses, expected at least 3");
  CHECK(message(truth, sample(wavy_pose, 1)) == "the estimate has 1 pose, expected at least 3");
  CHECK_THAT(message(truth, sample(wavy_pose, 5, 0.002, 5.003)), ContainsSubstring("larger tolerance"));
  const PoseTrajectory milliseconds = sample([](double t) { return wavy_pose(1e-3 * t); }, 1001, 10.0, 1e6);
  CHECK_THAT(message(truth, milliseconds), ContainsSubstring("the estimate's times look like milliseconds"));
  CHECK_THAT(message(milliseconds, truth), ContainsSubstring("the ground truth's times look like milliseconds"));
}

TEST_CASE("Positions too far from the origin to be squared are an error with their place") {
  const PoseTrajectory truth = sample(wavy_pose, 10);
  const PoseTrajectory far = testing::seen_from(truth, {1e-200, {}});
  CHECK_THROWS_WITH(associate(truth, far, {}),
                    ContainsSubstring("the estimate's pose at 0.000000 s is 1e+200 m from the origin"));
  CHECK_NOTHROW(associate(truth, testing::seen_from(truth, {1e-30, {}}), {}));
}

TEST_CASE("Empty trajectories and poses that are not finite are errors") {
  const PoseTrajectory truth = sample(wavy_pose, 10);
  CHECK_THROWS_WITH(associate(truth, {}, {}), ContainsSubstring("the estimate has no poses"));
  CHECK_THROWS_WITH(associate({}, truth, {}), ContainsSubstring("the ground truth has no poses"));
  std::vector<StampedPose> poses = truth.poses();
  poses[4].T.p.y() = std::nan("");
  CHECK_THROWS_WITH(associate(truth, PoseTrajectory(poses), {}), ContainsSubstring("estimate's pose at 0.040000 s"));
}

TEST_CASE("Coverage is the share of the ground truth's time, without gaps") {
  const std::vector<double> truth = times(0.0, 10.0, 0.005);
  CHECK(coverage(truth, truth) == Approx(1.0));
  CHECK(coverage(truth, times(0.0, 10.0, 0.4)) == Approx(1.0));
  CHECK(coverage(truth, times(0.0, 5.0, 0.01)) == Approx(0.5));
  CHECK(coverage(truth, times(7.5, 10.0, 0.01)) == Approx(0.25));
  CHECK(coverage(truth, joined(times(0.0, 2.0, 0.01), times(8.0, 10.0, 0.01))) == Approx(0.4));
}

TEST_CASE("A few poses far apart in time cover nothing") {
  CHECK(coverage(times(0.0, 20.0, 0.005), {{0.0, 10.0, 20.0}}) == 0.0);
}

TEST_CASE("Gaps of the ground truth do not change the coverage of an estimate") {
  const std::vector<double> truth = joined(times(0.0, 2.0, 0.005), times(4.0, 6.0, 0.005));
  CHECK(coverage(truth, truth) == Approx(1.0));
  CHECK(coverage(truth, times(0.0, 6.0, 0.5)) == Approx(1.0));
  CHECK(coverage(truth, times(0.0, 4.0, 0.5)) == Approx(0.5));
}

TEST_CASE("Unmatched poses of the estimate are counted, each once") {
  const PoseTrajectory truth = sample(wavy_pose, 11, 0.1), dense = sample(wavy_pose, 101, 0.01);
  const Association sparse = associate(truth, dense, {});
  CHECK(sparse.pairs.size() == 11);
  CHECK(sparse.unmatched == 90);
  CHECK(associate(dense, truth, {}).unmatched == 0);
  CHECK(associate(truth, dense, {.mode = AssociationMode::interpolated, .tolerance = 0.1}).unmatched == 0);
  // Two poses of the ground truth share one of the estimate.
  const PoseTrajectory late = sample(wavy_pose, 12, 0.0625, 0.03125);
  const Association shared = associate(sample(wavy_pose, 11, 0.0625), late, {.tolerance = 0.04});
  CHECK(shared.unmatched == late.size() - 10);
}

}  // namespace evbench
