#include "core/simulation/motion.hpp"

#include "core/data/tum.hpp"
#include "core/io/atomic_file.hpp"
#include "core/simulation/random.hpp"
#include "core/simulation/time_spans.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;

namespace {

Vector6 velocity(const Motion& motion, double t) {
  const double h = 1e-4;
  return se3::log(motion(t - h).inverse() * motion(t + h)) / (2.0 * h);
}

Motion motion_of(MotionOptions options, const std::string& folder = "", double duration = 10.0) {
  return make_motion(options, duration, 3, folder, "motion");
}

void check_smooth(const Motion& motion, double duration, double largest_jump) {
  for (double t = 0.01; t < duration - 0.01; t += 0.0037) {
    REQUIRE((velocity(motion, t + 0.001) - velocity(motion, t)).norm() < largest_jump);
  }
}

}  // namespace

TEST_CASE("Uniform and normal numbers have the moments that they should have, streams differ, seeds repeat") {
  Random random(1);
  double sum = 0.0, squares = 0.0, uniform = 0.0;
  constexpr int kN = 200000;
  for (int i = 0; i < kN; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
    uniform += random.uniform();
  }
  CHECK(sum / kN == Approx(0.0).margin(0.01));
  CHECK(squares / kN == Approx(1.0).margin(0.015));
  CHECK(uniform / kN == Approx(0.5).margin(0.005));
  CHECK(Random(1).next() == Random(1).next());
  CHECK(Random(1).next() != Random(2).next());
  CHECK(Random(1, 0).next() != Random(1, 1).next());
}

TEST_CASE("Built-in motions are smooth and stay within their amplitude") {
  MotionOptions options;
  options.kind = GENERATE("robot_arm", "smooth_random");
  const Motion motion = motion_of(options);
  check_smooth(motion, 10.0, 0.05);
  for (double t = 0.0; t < 10.0; t += 0.1) REQUIRE(motion(t).p.cwiseAbs().maxCoeff() <= options.amplitude);
  CHECK(sample_motion(motion, 10.0, 200.0).path_length() > 1.0);
}

TEST_CASE("The robot arm's motion repeats after its period") {
  const Motion motion = motion_of({});
  CHECK(se3::log(motion(1.3).inverse() * motion(7.3)).norm() < 1e-9);
}

TEST_CASE("A pace takes the camera along the same path in another time, and a falling one slows it down") {
  MotionOptions options;
  const Motion usual = motion_of(options);
  options.pace = {2.0, 2.0};
  const Motion twice = motion_of(options);
  for (double t = 0.0; t < 5.0; t += 0.1) REQUIRE((twice(t).p - usual(2.0 * t).p).norm() < 1e-12);
  options.pace = {4.0, 0.5};
  const Motion slowing = motion_of(options);
  check_smooth(slowing, 10.0, 0.05);
  // The pace is 4 (1/8)^(t/10): the motion's time is its integral.
  const auto own_time = [](double t) { return 40.0 / std::log(0.125) * (std::pow(0.125, t / 10.0) - 1.0); };
  for (double t = 0.0; t <= 10.0; t += 0.5) CHECK((slowing(t).p - usual(own_time(t)).p).norm() < 1e-9);
  CHECK(velocity(slowing, 0.01).norm() == Approx(4.0 * velocity(usual, own_time(0.01)).norm()).epsilon(0.01));
  CHECK(velocity(slowing, 9.99).norm() == Approx(0.5 * velocity(usual, own_time(9.99)).norm()).epsilon(0.01));
}

TEST_CASE("A trajectory file is followed, with continuous velocity") {
  const testing::TemporaryFolder folder;
  const Motion truth = motion_of({});
  write_file(folder.file("path.txt"), format_tum(sample_motion(truth, 10.0, 50.0)));
  MotionOptions options;
  options.kind = "trajectory";
  options.trajectory = "path.txt";
  options.start = 1.0;
  options.knot_rate = 0.0;
  const Motion motion = motion_of(options, folder.path(), 8.0);
  check_smooth(motion, 8.0, 0.05);
  for (double t = 0.0; t <= 8.0; t += 0.013) {
    REQUIRE(se3::log(truth(t + 1.0).inverse() * motion(t)).norm() < 1e-4);
  }
}

TEST_CASE("A motion through few poses of a trajectory has no jump of acceleration at them") {
  const testing::TemporaryFolder folder;
  write_file(folder.file("path.txt"), format_tum(sample_motion(motion_of({}), 10.0, 50.0)));
  MotionOptions options;
  options.kind = "trajectory";
  options.trajectory = "path.txt";
  options.knot_rate = 4.0;
  const Motion motion = motion_of(options, folder.path());
  const auto acceleration = [&](double t) -> Vector6 {
    return (velocity(motion, t + 1e-4) - velocity(motion, t - 1e-4)) / 2e-4;
  };
  for (double t = 0.25; t < 9.9; t += 0.25) {
    REQUIRE((acceleration(t + 5e-4) - acceleration(t - 5e-4)).norm() < 0.01);
  }
}

TEST_CASE("Poses of a trajectory that are far apart where it is followed are remarked on") {
  const testing::TemporaryFolder folder;
  std::vector<StampedPose> poses = sample_motion(motion_of({}), 10.0, 50.0).poses();
  std::erase_if(poses, [](const StampedPose& pose) {
    return (pose.t > 2.01 && pose.t < 4.49) || (pose.t > 6.01 && pose.t < 6.49);
  });
  write_file(folder.file("path.txt"), format_tum(PoseTrajectory(std::move(poses))));
  const auto remarks = [&](double start, double duration) {
    MotionOptions options;
    options.kind = "trajectory";
    options.trajectory = "path.txt";
    options.start = start;
    std::vector<std::string> texts;
    make_motion(options, duration, 3, folder.path(), "motion", &texts);
    return texts;
  };
  CHECK(remarks(0.0, 1.9).empty());
  CHECK(remarks(7.0, 2.0).empty());
  const auto both = remarks(0.0, 9.0);
  REQUIRE(both.size() == 1);
  CHECK_THAT(both[0], ContainsSubstring("path.txt has 2 gaps") && ContainsSubstring("up to 2.50 s (from 2.00 s"));
  const auto one = remarks(5.0, 3.0);
  REQUIRE(one.size() == 1);
  CHECK_THAT(one[0], ContainsSubstring("one gap") && ContainsSubstring("up to 0.50 s (from 6.00 s"));
}

TEST_CASE("A camera on hold rests, one that only rotates keeps its place, and neither jumps") {
  MotionOptions options;
  options.hold = {2.0, 3.0};
  options.rotation_only = {5.0, 6.0};
  const Motion motion = motion_of(options);
  CHECK(velocity(motion, 2.5).norm() < 1e-9);
  CHECK(velocity(motion, 5.5).tail<3>().norm() < 1e-9);
  CHECK(velocity(motion, 5.5).head<3>().norm() > 0.01);
  CHECK(velocity(motion, 8.0).tail<3>().norm() > 0.01);
  check_smooth(motion, 10.0, 0.05);
  options.rotation_only = {2.5, 4.0};
  CHECK_THROWS_AS(motion_of(options), InputError);
}

TEST_CASE("Time spans that are no pairs, empty, out of order or too near are refused") {
  CHECK(parse_time_spans({1, 2, 3, 4}, "x").size() == 2);
  CHECK_THROWS_AS(parse_time_spans({1}, "x"), InputError);
  CHECK_THROWS_AS(parse_time_spans({2, 1}, "x"), InputError);
  CHECK_THROWS_AS(parse_time_spans({3, 4, 1, 2}, "x"), InputError);
  CHECK_THROWS_AS(parse_time_spans({1, 2, 2.1, 3}, "x", 0.4), InputError);
}
