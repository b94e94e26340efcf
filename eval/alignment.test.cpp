#include "eval/alignment.hpp"

#include "core/testing/catch2.hpp"
#include "eval/pose_error.hpp"
#include "eval/testing/trajectories.hpp"

namespace evbench {
namespace {

using namespace testing;

const Similarity kSimilarity = {2.5, {so3::exp({0.4, -1.2, 2.0}), {3.0, -1.0, 0.5}}};
const Similarity kRigid = {1.0, kSimilarity.T};

void check_equal(const Similarity& found, const Similarity& expected) {
  CHECK(found.scale == Approx(expected.scale).epsilon(1e-10));
  CHECK((found.T.p - expected.T.p).norm() < 1e-9);
  CHECK((found.T.q.conjugate() * expected.T.q).vec().norm() < 1e-9);
}

/// Sums of squares of the errors after an alignment.
struct Left {
  double trans = 0.0, rot = 0.0;
};

Left left_after(std::vector<PosePair> pairs, const Similarity& transform) {
  for (PosePair& pair : pairs) pair.estimate = transform * pair.estimate;
  const PoseErrors errors = absolute_errors(pairs);
  Left left;
  for (std::size_t i = 0; i < errors.trans_m.size(); ++i) {
    left.trans += errors.trans_m[i] * errors.trans_m[i];
    left.rot += errors.rot_deg[i] * errors.rot_deg[i];
  }
  return left;
}

}  // namespace

TEST_CASE("Sim(3) alignment recovers a known scale, rotation and translation") {
  const PoseTrajectory truth = sample(wavy_pose, 200, 0.05);
  check_equal(align(paired(truth, seen_from(truth, kSimilarity)), AlignmentMethod::sim3).transform, kSimilarity);
}

TEST_CASE("SE(3) alignment recovers a known rotation and translation and leaves the scale") {
  const PoseTrajectory truth = sample(wavy_pose, 200, 0.05);
  check_equal(align(paired(truth, seen_from(truth, kRigid)), AlignmentMethod::se3).transform, kRigid);
  CHECK(align(paired(truth, seen_from(truth, kSimilarity)), AlignmentMethod::se3).transform.scale == 1.0);
}

TEST_CASE("Scale alignment changes nothing but the scale") {
  const PoseTrajectory truth = sample(wavy_pose, 200, 0.05);
  check_equal(align(paired(truth, seen_from(truth, kSimilarity)), AlignmentMethod::scale).transform, {2.5, SE3{}});
}

TEST_CASE("Yaw alignment recovers a rotation about z and leaves roll and pitch") {
  const PoseTrajectory truth = sample(wavy_pose, 200, 0.05);
  const Similarity yaw = {1.0, {so3::exp({0.0, 0.0, 2.6}), {1.0, 2.0, 3.0}}};
  check_equal(align(paired(truth, seen_from(truth, yaw)), AlignmentMethod::yaw).transform, yaw);
  const Similarity tilted = {1.0, {so3::exp({0.3, 0.2, 2.6}), {1.0, 2.0, 3.0}}};
  const SE3 found = align(paired(truth, seen_from(truth, tilted)), AlignmentMethod::yaw).transform.T;
  CHECK((found.q * Vector3::UnitZ() - Vector3::UnitZ()).norm() < 1e-12);
}

TEST_CASE("Origin alignment makes the first poses equal") {
  const PoseTrajectory truth = sample(wavy_pose, 20, 0.05);
  const auto pairs = paired(truth, disturbed(seen_from(truth, kRigid)));
  const SE3 first = align(pairs, AlignmentMethod::origin).transform * pairs[0].estimate;
  CHECK(se3::log(first.inverse() * pairs[0].ground_truth).norm() < 1e-12);
}

TEST_CASE("No small change of an alignment gives less error") {
  const PoseTrajectory truth = sample(wavy_pose, 200, 0.05);
  const auto pairs = paired(truth, disturbed(seen_from(truth, kSimilarity), 0.1));
  for (const AlignmentMethod method : {AlignmentMethod::se3, AlignmentMethod::sim3, AlignmentMethod::yaw}) {
    const Similarity best = align(pairs, method).transform;
    const double least = left_after(pairs, best).trans;
    for (int k = 0; k < 6; ++k) {
      if (method == AlignmentMethod::yaw && k < 2) continue;  // yaw alignment has no roll and pitch
      for (const double step : {-1e-3, 1e-3}) {
        Vector6 change = Vector6::Zero();
        change[k] = step;
        CHECK(left_after(pairs, {best.scale, se3::exp(change) * best.T}).trans > least);
      }
    }
    if (method != AlignmentMethod::sim3) continue;
    CHECK(left_after(pairs, {best.scale * 1.001, best.T}).trans > least);
    CHECK(left_after(pairs, {best.scale * 0.999, best.T}).trans > least);
  }
}

TEST_CASE("Mirrored positions are aligned by a rotation, not by a reflection") {
  const PoseTrajectory truth = sample(wavy_pose, 200, 0.05);
  auto pairs = paired(truth, truth);
  for (PosePair& pair : pairs) pair.estimate.p.x() *= -1.0;
  CHECK(align(pairs, AlignmentMethod::sim3).transform.T.R().determinant() == Approx(1.0));
}

TEST_CASE("On a straight line the rotation about it comes from the orientations") {
  const auto slider = [](double t) { return SE3{wavy_pose(t).q, {t, 2.0 * t, -t}}; };
  const PoseTrajectory truth = sample(slider, 100, 0.05);
  const Alignment found = align(paired(truth, seen_from(truth, kSimilarity)), AlignmentMethod::sim3);
  check_equal(found.transform, kSimilarity);
  CHECK(found.note.find("on a line") != std::string::npos);
}

TEST_CASE("A stationary trajectory keeps scale 1, with a note") {
  const auto standing = [](double t) { return SE3{wavy_pose(t).q, {1.0, 2.0, 3.0}}; };
  const PoseTrajectory still = sample(standing, 50, 0.05);
  const PoseTrajectory moving = sample(wavy_pose, 50, 0.05);
  for (const AlignmentMethod method : {AlignmentMethod::se3, AlignmentMethod::sim3, AlignmentMethod::scale}) {
    const Alignment estimate_still = align(paired(moving, still), method);
    CHECK(estimate_still.transform.scale == 1.0);
    CHECK(estimate_still.note.find("the estimate is stationary") == 0);
    // Umeyama's scale would be 0 here, and so would be the error.
    const Alignment truth_still = align(paired(still, moving), method);
    CHECK(truth_still.transform.scale == 1.0);
    CHECK(truth_still.note.find("the ground truth is stationary") == 0);
  }
  const auto pairs = paired(still, seen_from(still, kRigid));
  const Left left = left_after(pairs, align(pairs, AlignmentMethod::se3).transform);
  CHECK(left.trans < 1e-18);
  CHECK(left.rot < 1e-18);
}

TEST_CASE("Without horizontal motion the yaw comes from the orientations") {
  const auto lift = [](double t) { return SE3{wavy_pose(t).q, {0.0, 0.0, t}}; };
  const PoseTrajectory truth = sample(lift, 100, 0.05);
  const Similarity yaw = {1.0, {so3::exp({0.0, 0.0, -1.0}), {1.0, 2.0, 3.0}}};
  const Alignment found = align(paired(truth, seen_from(truth, yaw)), AlignmentMethod::yaw);
  check_equal(found.transform, yaw);
  CHECK(found.note.find("no horizontal motion") == 0);
}

TEST_CASE("Aligning on fewer than three pairs is an error") {
  const PoseTrajectory truth = sample(wavy_pose, 2);
  CHECK_THROWS_WITH(align(paired(truth, truth), AlignmentMethod::sim3),
                    "2 pairs of poses to align on; sim3 alignment needs at least 3");
}

}  // namespace evbench
