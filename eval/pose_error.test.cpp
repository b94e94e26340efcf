#include "eval/pose_error.hpp"

#include <numbers>

#include "core/testing/catch2.hpp"
#include "eval/testing/trajectories.hpp"

namespace evbench {
namespace {

using namespace testing;
using IndexPairs = std::vector<std::pair<std::size_t, std::size_t>>;

constexpr double kDegree = std::numbers::pi / 180.0;

/// Along x at these places, one pose per second, rotating by 1.001 degrees per pose.
std::vector<PosePair> at_places(const std::vector<double>& places) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto index = static_cast<double>(i);
    const SE3 pose = {so3::exp({0.0, 0.0, 1.001 * kDegree * index}), {places[i], 0.0, 0.0}};
    pairs.push_back({index, pose, pose});
  }
  return pairs;
}

std::vector<double> steps(int count, double step) {
  std::vector<double> places;
  for (int i = 0; i < count; ++i) places.push_back(step * i);
  return places;
}

}  // namespace

TEST_CASE("Errors of a trajectory with itself are zero") {
  const PoseTrajectory truth = sample(wavy_pose, 100, 0.05);
  const auto pairs = paired(truth, truth);
  for (const double error : absolute_errors(pairs).trans_m) CHECK(error == 0.0);
  for (const double error : absolute_errors(pairs).rot_deg) CHECK(error < 1e-12);
  const PoseErrors relative = relative_errors(pairs, delta_pairs(pairs, {.delta = 1.0, .tolerance = 0.01}));
  REQUIRE(relative.trans_m.size() == 80);
  for (const double error : relative.trans_m) CHECK(error < 1e-14);
  for (const double error : relative.rot_deg) CHECK(error < 1e-12);
}

TEST_CASE("Absolute errors are distances in metres and angles in degrees") {
  const PosePair pair = {0.0, {}, {so3::exp({0.0, 170.0 * kDegree, 0.0}), {0.0, 3.0, 4.0}}};
  const PoseErrors errors = absolute_errors({{pair}});
  CHECK(errors.trans_m[0] == Approx(5.0));
  CHECK(errors.rot_deg[0] == Approx(170.0));
}

TEST_CASE("Relative errors do not depend on the estimate's world frame") {
  const PoseTrajectory truth = sample(wavy_pose, 100, 0.05);
  const PoseTrajectory estimate = disturbed(truth);
  const auto here = paired(truth, estimate);
  const auto there = paired(truth, seen_from(estimate, {1.0, {so3::exp({1.0, 2.0, -1.0}), {5.0, 6.0, 7.0}}}));
  const auto indices = delta_pairs(here, {.delta = 0.5});
  const PoseErrors a = relative_errors(here, indices), b = relative_errors(there, indices);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    CHECK(a.trans_m[i] == Approx(b.trans_m[i]).epsilon(1e-9));
    CHECK(a.rot_deg[i] == Approx(b.rot_deg[i]).epsilon(1e-9));
  }
}

TEST_CASE("Pairs a number of frames apart") {
  const auto pairs = at_places(steps(7, 1.0));
  RelativeOptions options = {.delta = 3.0, .unit = DeltaUnit::frames};
  CHECK(delta_pairs(pairs, options) == IndexPairs{{0, 3}, {1, 4}, {2, 5}, {3, 6}});
  options.pairing = Pairing::consecutive;
  CHECK(delta_pairs(pairs, options) == IndexPairs{{0, 3}, {3, 6}});
  options.delta = 7.0;
  CHECK(delta_pairs(pairs, options).empty());
}

TEST_CASE("Pairs a number of seconds apart are within the tolerance") {
  auto pairs = at_places(steps(8, 1.0));
  for (std::size_t i = 4; i < 8; ++i) pairs[i].t += 0.5;  // 0 1 2 3 4.5 5.5 6.5 7.5
  RelativeOptions options = {.delta = 2.0};
  CHECK(delta_pairs(pairs, options) == IndexPairs{{0, 2}, {1, 3}, {4, 6}, {5, 7}});
  options.pairing = Pairing::consecutive;
  CHECK(delta_pairs(pairs, options) == IndexPairs{{0, 2}, {4, 6}});
  options.tolerance = 0.25;
  CHECK(delta_pairs(pairs, options) == IndexPairs{{0, 2}, {2, 4}, {4, 6}});
}

TEST_CASE("Pairs a number of metres apart along the path") {
  const auto pairs = at_places({0.0, 0.6, 1.2, 0.19, 0.19, 0.7, 1.24});  // path 0 0.6 1.2 2.21 2.21 2.72 3.26
  RelativeOptions options = {.delta = 1.0, .unit = DeltaUnit::metres};
  CHECK(delta_pairs(pairs, options) == IndexPairs{{2, 3}, {3, 6}, {4, 6}});
  options.pairing = Pairing::consecutive;
  CHECK(delta_pairs(pairs, options) == IndexPairs{{2, 3}, {3, 6}});  // the first metre is not used, as in evo
}

TEST_CASE("Pairs a number of degrees apart") {
  const auto pairs = at_places(steps(8, 1.0));
  RelativeOptions options = {.delta = 3.0, .unit = DeltaUnit::degrees};
  CHECK(delta_pairs(pairs, options) == IndexPairs{{0, 3}, {1, 4}, {2, 5}, {3, 6}, {4, 7}});
  options.pairing = Pairing::consecutive;
  CHECK(delta_pairs(pairs, options) == IndexPairs{{0, 3}, {3, 6}});
}

TEST_CASE("The path can be measured on the ground truth") {
  auto pairs = at_places(steps(9, 0.25));
  for (PosePair& pair : pairs) pair.estimate.p *= 2.0;
  RelativeOptions options = {.delta = 1.0, .unit = DeltaUnit::metres};
  CHECK(delta_pairs(pairs, options).front() == std::pair<std::size_t, std::size_t>{0, 2});
  options.source = PairSource::ground_truth;
  CHECK(delta_pairs(pairs, options).front() == std::pair<std::size_t, std::size_t>{0, 4});
}

TEST_CASE("A delta out of range is an error") {
  const auto pairs = at_places(steps(8, 1.0));
  const auto message = [&](double delta, DeltaUnit unit) -> std::string {
    try {
      delta_pairs(pairs, {.delta = delta, .unit = unit});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  CHECK(message(0.0, DeltaUnit::seconds) == "the delta of the relative error is 0 seconds; expected a number above 0");
  CHECK(message(1.5, DeltaUnit::frames) == "the delta of the relative error is 1.5 frames; expected a whole number");
  CHECK(message(181.0, DeltaUnit::degrees) == "the delta of the relative error is 181 degrees; expected at most 180");
}

}  // namespace evbench
