#include "eval/velocity_error.hpp"

#include <cmath>
#include <numbers>

#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "eval/scores.hpp"

namespace evbench {
namespace {

const Vector6 kTwist = (Vector6() << 0.3, -0.7, 0.5, 0.4, 0.1, -0.2).finished();

/// Constant body velocity, at times that are not evenly spaced.
PoseTrajectory screw(double scale = 1.0) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < 400; ++i) {
    const double t = 0.01 * i + 0.003 * std::sin(i);
    SE3 T = se3::exp(t * kTwist);
    T.p *= scale;
    poses.push_back({t, T});
  }
  return PoseTrajectory(std::move(poses));
}

}  // namespace

TEST_CASE("The velocity of a screw motion is found to 1e-9, between and at its poses, and not at its ends") {
  const PoseTrajectory trajectory = screw();
  for (const double t : {0.5, trajectory.poses()[100].t, 3.3}) {
    const auto velocity = differentiate(trajectory, t);
    REQUIRE(velocity);
    CHECK((*velocity - kTwist).norm() < 1e-9);
  }
  CHECK_FALSE(differentiate(trajectory, trajectory.start()));
  CHECK_FALSE(differentiate(trajectory, trajectory.end() + 0.1));
  CHECK_FALSE(differentiate({}, 0.0));
}

TEST_CASE("The velocity of a motion that swings once in 2 s is found to 2e-5 of its speed at 200 Hz") {
  const double rate = 2.0 * std::numbers::pi * 0.5;
  std::vector<StampedPose> poses;
  for (int i = 0; i < 1000; ++i) {
    const double t = 0.005 * i;
    poses.push_back({t, {Eigen::Quaterniond::Identity(), {std::sin(rate * t), 0.0, 0.0}}});
  }
  const PoseTrajectory trajectory(std::move(poses));
  for (const double t : {1.0, 1.25, 2.355}) {
    CHECK(std::abs(differentiate(trajectory, t)->coeff(3) - rate * std::cos(rate * t)) < 2e-5 * rate);
  }
}

TEST_CASE("The area under the curve of relative velocity errors equals that of the EvSLAM benchmark's definition") {
  std::vector<VelocityPair> pairs;
  for (int i = 0; i < 50; ++i) {
    Vector6 truth = Vector6::Zero(), estimate = Vector6::Zero();
    truth.tail<3>() = Vector3(1.0 + 0.1 * i, 0.0, 0.0);
    estimate.tail<3>() = truth.tail<3>() * (1.0 + 0.03 * i);
    pairs.push_back({truth, estimate});
  }
  // numpy: xi = linspace(0, 1, 500); trapz([sum(w[rve < x]) / sum(w) for x in xi], xi) with rve = 0.03 i, w = 1 + 0.1 i
  double weights = 0.0, area = 0.0, last = 0.0;
  for (int i = 0; i < 50; ++i) weights += 1.0 + 0.1 * i;
  for (int k = 0; k < 500; ++k) {
    double below = 0.0;
    for (int i = 0; i < 50; ++i) {
      const double speed = 1.0 + 0.1 * i;
      if (std::abs(speed - speed * (1.0 + 0.03 * i)) / speed < k / 499.0) below += speed;
    }
    if (k > 0) area += 0.5 * (last + below / weights) / 499.0;
    last = below / weights;
  }
  const VelocityErrors errors = velocity_errors(pairs);
  CHECK(errors.linear.auc == Approx(area).epsilon(1e-12));
  CHECK(errors.linear.median == Approx(0.03 * 24.5));
  CHECK(errors.times == 50);
  CHECK(std::isnan(errors.angular.auc));  // nothing turns

  const auto at_rest = velocity_errors(std::vector<VelocityPair>{{Vector6::Zero(), Vector6::Ones()}});
  CHECK(std::isnan(at_rest.linear.auc));
}

TEST_CASE("Velocities are scored at the scale of the alignment, by the estimate's own and by differentiation") {
  const PoseTrajectory truth = screw(), estimate = screw(0.25);
  Scores scores = score(truth, estimate, {.alignment = "sim3"});
  std::vector<StampedVelocity> own;
  for (const StampedPose& pose : estimate.poses()) {
    own.push_back({pose.t, kTwist});
    own.back().velocity.tail<3>() *= 0.25 * 1.1;  // 10 % too fast
  }
  score_velocities(truth, {}, estimate, BodyVelocities(own), scores);
  REQUIRE(scores.velocity);
  REQUIRE(scores.velocity->own);
  CHECK(scores.velocity->own->linear.median == Approx(0.1).epsilon(1e-6));
  CHECK(scores.velocity->own->linear.auc == Approx(0.9).margin(0.002));
  CHECK(scores.velocity->own->angular.median < 1e-6);
  CHECK(scores.velocity->differentiated.linear.median < 1e-6);
  CHECK(scores.velocity->differentiated.linear.auc > 0.998);
  const Json json = to_json(scores);
  CHECK(json.at("velocity").at("source") == "own");
  CHECK(json.at("velocity").at("rve").at("median").get<double>() == scores.velocity->own->linear.median);

  score_velocities(truth, {}, estimate, {}, scores);
  CHECK_FALSE(scores.velocity->own);
  CHECK(to_json(scores).at("velocity").at("source") == "differentiated");
}

TEST_CASE("Stated velocities are interpolated between neighbours only") {
  const BodyVelocities velocities({{0.0, Vector6::Zero()}, {0.05, Vector6::Ones()}, {1.0, Vector6::Ones()}});
  CHECK(velocities.at(0.025)->isApprox(0.5 * Vector6::Ones()));
  CHECK(velocities.at(1.0)->isApprox(Vector6::Ones()));
  CHECK_FALSE(velocities.at(0.5));
  CHECK_FALSE(velocities.at(-0.01));
  CHECK_FALSE(velocities.at(1.01));
}

}  // namespace evbench
