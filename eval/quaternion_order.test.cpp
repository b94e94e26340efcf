#include "eval/quaternion_order.hpp"

#include "core/testing/catch2.hpp"
#include "eval/testing/trajectories.hpp"

namespace evbench {
namespace {

using testing::disturbed;
using testing::paired;
using testing::sample;
using testing::wavy_pose;

constexpr std::array kOrders{QuaternionOrder::xyzw, QuaternionOrder::wxyz, QuaternionOrder::zwxy,
                             QuaternionOrder::yzwx};

/// The result of reading columns in one order as another.
Eigen::Quaterniond misread(const Eigen::Quaterniond& q, QuaternionOrder order, QuaternionOrder taken) {
  const auto component = [](char name) { return std::string("xyzw").find(name); };
  const std::string written = kQuaternionOrderNames[static_cast<std::size_t>(order)];
  const std::string read = kQuaternionOrderNames[static_cast<std::size_t>(taken)];
  Eigen::Quaterniond result;
  for (std::size_t i = 0; i < 4; ++i) {
    result.coeffs()[static_cast<Eigen::Index>(component(read[i]))] =
        q.coeffs()[static_cast<Eigen::Index>(component(written[i]))];
  }
  return result;
}

/// An estimate with small errors in another world frame, with a rotated body frame.
std::vector<PosePair> pairs_of(const Eigen::Quaterniond& frame = Eigen::Quaterniond::Identity()) {
  const PoseTrajectory truth = sample(wavy_pose, 400, 0.05);
  const SE3 world{so3::exp({0.4, -1.1, 0.7}), {1.0, 2.0, 3.0}};
  std::vector<PosePair> pairs = paired(truth, disturbed(truth, 0.01));
  for (PosePair& pair : pairs) pair.estimate = world * pair.estimate * SE3{frame, Vector3::Zero()};
  return pairs;
}

}  // namespace

TEST_CASE("The true order of an estimate's quaternions is found, in whatever order they were read") {
  for (const QuaternionOrder order : kOrders) {
    for (const QuaternionOrder taken : kOrders) {
      CAPTURE(kQuaternionOrderNames[static_cast<std::size_t>(order)],
              kQuaternionOrderNames[static_cast<std::size_t>(taken)]);
      std::vector<PosePair> pairs = pairs_of();
      for (PosePair& pair : pairs) pair.estimate.q = misread(pair.estimate.q, order, taken);
      const auto better = better_quaternion_order(pairs, {.ground_truth = QuaternionOrder::xyzw, .estimate = taken});
      REQUIRE(better.has_value() == (order != taken));
      if (!better) continue;
      CHECK(better->order == order);
      CHECK_FALSE(better->of_ground_truth);
      CHECK_FALSE(better->frames_differ);
      CHECK(better->reordered_deg < 3.0);
      CHECK(better->as_read_deg > 10.0);
    }
  }
}

TEST_CASE("The ground truth's order is reported if only that fits, or if it was assumed") {
  std::vector<PosePair> pairs = pairs_of();
  for (PosePair& pair : pairs) {
    pair.ground_truth.q = misread(pair.ground_truth.q, QuaternionOrder::wxyz, QuaternionOrder::xyzw);
  }
  QuaternionOrders read{.ground_truth = QuaternionOrder::xyzw, .estimate = QuaternionOrder::xyzw};
  auto better = better_quaternion_order(pairs, read);
  REQUIRE(better);
  CHECK(better->of_ground_truth);
  CHECK(better->order == QuaternionOrder::wxyz);

  // In one world frame both fit.
  const PoseTrajectory truth = sample(wavy_pose, 400, 0.05);
  pairs = paired(truth, truth);
  for (PosePair& pair : pairs) {
    pair.ground_truth.q = misread(pair.ground_truth.q, QuaternionOrder::wxyz, QuaternionOrder::xyzw);
  }
  better = better_quaternion_order(pairs, read);
  REQUIRE(better);
  CHECK_FALSE(better->of_ground_truth);
  read.ground_truth_is_assumed = true;
  better = better_quaternion_order(pairs, read);
  REQUIRE(better);
  CHECK(better->of_ground_truth);
  CHECK(better->order == QuaternionOrder::wxyz);
  read.ground_truth = QuaternionOrder::automatic;  // matrices
  better = better_quaternion_order(pairs, read);
  REQUIRE(better);
  CHECK_FALSE(better->of_ground_truth);
}

TEST_CASE("The order is also found for another body frame") {
  std::vector<PosePair> pairs = pairs_of(so3::exp({0.3, 2.0, -0.8}));
  const QuaternionOrders read{.ground_truth = QuaternionOrder::xyzw, .estimate = QuaternionOrder::xyzw};
  CHECK_FALSE(better_quaternion_order(pairs, read));
  for (PosePair& pair : pairs) pair.estimate.q = misread(pair.estimate.q, QuaternionOrder::wxyz, QuaternionOrder::xyzw);
  const auto better = better_quaternion_order(pairs, read);
  REQUIRE(better);
  CHECK(better->frames_differ);
  CHECK(better->order == QuaternionOrder::wxyz);
}

TEST_CASE("No order is proposed without rotation, for poor estimates, and without quaternions") {
  const QuaternionOrders read{.ground_truth = QuaternionOrder::xyzw, .estimate = QuaternionOrder::xyzw};
  const PoseTrajectory straight = sample([](double t) { return SE3{so3::exp({0.0, 0.0, 1.0}), {t, 0.0, 0.0}}; }, 100);
  CHECK_FALSE(better_quaternion_order(paired(straight, straight), read));
  const PoseTrajectory truth = sample(wavy_pose, 400, 0.05);
  CHECK_FALSE(better_quaternion_order(paired(truth, disturbed(truth, 0.8)), read));
  std::vector<PosePair> pairs = pairs_of();
  for (PosePair& pair : pairs) pair.estimate.q = misread(pair.estimate.q, QuaternionOrder::wxyz, QuaternionOrder::xyzw);
  CHECK_FALSE(better_quaternion_order(pairs, {}));
}

}  // namespace evbench
