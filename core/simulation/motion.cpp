#include "core/simulation/motion.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "core/data/pose_file.hpp"
#include "core/geometry/so3.hpp"
#include "core/io/path.hpp"
#include "core/motion/pose_spline.hpp"
#include "core/simulation/random.hpp"
#include "core/simulation/time_spans.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr double kTurn = 2.0 * M_PI;

/// One coordinate as a sum of sinusoids, |value| ≤ amplitude.
struct Wave {
  std::array<double, 3> amplitude, frequency, phase;

  Wave(double total, double max_frequency, Random& random) : amplitude{}, frequency{}, phase{} {
    double sum = 0.0;
    for (std::size_t i = 0; i < amplitude.size(); ++i) {
      frequency[i] = max_frequency * random.uniform(0.1, 1.0);
      amplitude[i] = random.uniform(0.5, 1.0) / (1.0 + frequency[i] / max_frequency);  // slow waves are the large ones
      phase[i] = random.uniform(0.0, kTurn);
      sum += amplitude[i];
    }
    for (double& a : amplitude) a *= total / sum;
  }

  double operator()(double t) const {
    double value = 0.0;
    for (std::size_t i = 0; i < amplitude.size(); ++i) {
      value += amplitude[i] * std::sin(kTurn * frequency[i] * t + phase[i]);
    }
    return value;
  }
};

Motion smooth_random(const MotionOptions& options, std::uint64_t seed) {
  Random random(seed);
  std::vector<Wave> waves;
  for (int axis = 0; axis < 3; ++axis) waves.emplace_back(options.amplitude, options.max_frequency, random);
  for (int axis = 0; axis < 3; ++axis) waves.emplace_back(options.rotation_amplitude, options.max_frequency, random);
  return [waves](double t) {
    const Vector3 p(waves[0](t), waves[1](t), waves[2](t));
    return SE3{so3::exp({waves[3](t), waves[4](t), waves[5](t)}), p};
  };
}

Motion robot_arm(const MotionOptions& options, std::uint64_t seed) {
  const double phase = Random(seed).uniform(0.0, kTurn);
  return [options, phase](double t) {
    const double a = kTurn * t / options.period + phase;
    const Vector3 p = options.amplitude * Vector3(std::cos(a), 0.7 * std::sin(a), 0.3 * std::sin(2.0 * a + 0.5));
    const Vector3 view = Vector3(0.0, 0.0, options.distance) - p;
    const Eigen::Quaterniond facing = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), view);
    const Vector3 roll(0.0, 0.0, options.rotation_amplitude * std::sin(a + 1.0));
    return SE3{facing * so3::exp(roll), p};
  };
}

/// The trajectory's poses, or interpolated ones at about `rate` [Hz] when rate > 0.
std::vector<StampedPose> knots_of(const PoseTrajectory& file, double rate) {
  const double length = file.end() - file.start();
  if (!(rate > 0.0) || !(length > 0.0)) return file.poses();
  std::vector<StampedPose> knots;
  const int intervals = std::max(1, static_cast<int>(std::ceil(length * rate)));
  for (int i = 0; i <= intervals; ++i) {
    const double t = std::min(file.start() + length * i / intervals, file.end());
    knots.push_back({t, *file.pose(t)});
  }
  return knots;
}

/// The motion's own time, which runs at the pace in the options.
class PaceClock {
 public:
  PaceClock(const std::vector<double>& pace, double duration)
      : from_(pace[0]), growth_(duration > 0.0 ? std::log(pace[1] / pace[0]) / duration : 0.0) {}

  double operator()(double t) const { return growth_ == 0.0 ? from_ * t : from_ * std::expm1(growth_ * t) / growth_; }

 private:
  double from_;    ///< pace at the beginning
  double growth_;  ///< of its logarithm [1/s]
};

/// A remark on poses from `begin` to `end` [s] that are far apart: the camera's motion between them is made up.
std::optional<std::string> remark_on_gaps(const PoseTrajectory& file, double begin, double end,
                                          const std::string& name) {
  constexpr double kGap = 0.2;  // [s]; motion capture has 0.01, and rarely misses more than 0.1
  const std::vector<StampedPose>& poses = file.poses();
  const auto gap = [&](std::size_t i) { return poses[i + 1].t - poses[i].t; };
  std::optional<std::size_t> longest;
  int gaps = 0;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    if (gap(i) <= kGap || poses[i + 1].t <= begin || poses[i].t >= end) continue;
    ++gaps;
    if (!longest || gap(i) > gap(*longest)) longest = i;
  }
  if (!longest) return std::nullopt;
  return fmt::format(
      "{} has {} of more than {:g} s between its poses, up to {:.2f} s (from {:.2f} s after its first "
      "one): the camera's motion there is interpolated",
      name, gaps == 1 ? "one gap" : fmt::format("{} gaps", gaps), kGap, gap(*longest),
      poses[*longest].t - file.start());
}

Motion from_trajectory(const MotionOptions& options, double duration, const std::string& folder,
                       const std::string& place, std::vector<std::string>* remarks) {
  if (options.trajectory.empty()) {
    throw InputError(fmt::format("{}.trajectory: is empty; expected the path of a trajectory", place));
  }
  const PoseFile poses =
      read_poses(resolve_path(options.trajectory, folder), {.quaternion = options.trajectory_quaternion});
  if (remarks != nullptr) remarks->insert(remarks->end(), poses.remarks.begin(), poses.remarks.end());
  const PoseTrajectory& file = poses.trajectory;
  constexpr double kFarApart = 100.0;  // [s] between two poses: those of no camera's motion
  if (file.size() > 1 && file.end() - file.start() > kFarApart * static_cast<double>(file.size() - 1)) {
    throw InputError(fmt::format("{}.trajectory: {} has {} poses from {} to {} s; expected times in seconds", place,
                                 options.trajectory, file.size(), file.start(), file.end()));
  }
  const double begin = file.start() + options.start;
  if (begin + duration > file.end()) {
    throw InputError(
        fmt::format("{}.trajectory: {} lasts {:.3f} s; expected at least start and duration at its pace = {:.3f} s",
                    place, options.trajectory, file.end() - file.start(), options.start + duration));
  }
  if (remarks != nullptr) {
    if (const auto remark = remark_on_gaps(file, begin, begin + duration, options.trajectory)) {
      remarks->push_back(*remark);
    }
  }
  std::vector<StampedPose> knots = knots_of(file, options.knot_rate);
  for (StampedPose& knot : knots) knot.T.p *= options.scale;
  return [spline = PoseSpline(PoseTrajectory(std::move(knots))), begin](double t) { return spline.at(begin + t); };
}

Motion base_motion(const MotionOptions& options, double duration, std::uint64_t seed, const std::string& folder,
                   const std::string& place, std::vector<std::string>* remarks) {
  if (options.kind == "smooth_random") return smooth_random(options, seed);
  if (options.kind == "robot_arm") return robot_arm(options, seed);
  return from_trajectory(options, duration, folder, place, remarks);
}

}  // namespace

void MotionOptions::declare(OptionSet& set) {
  set.add("kind", kind, "how the camera moves").choices({"smooth_random", "robot_arm", "trajectory"});
  set.add("amplitude", amplitude, "largest excursion of the position an axis [m] (not trajectory)").range(0.0, 1e6);
  set.add("rotation_amplitude", rotation_amplitude,
          "largest rotation an axis (smooth_random), largest roll (robot_arm) [rad]")
      .range(0.0, 1.5);
  set.add("max_frequency", max_frequency, "fastest sinusoid of smooth_random [Hz]").range(0.0, 1e3).above(0.0);
  set.add("period", period, "time after which robot_arm repeats [s]").above(0.0);
  set.add("distance", distance, "distance of the point that robot_arm faces [m]").above(0.0);
  set.add("trajectory", trajectory, "path of a trajectory to follow: its poses are joined by a smooth (C2) spline")
      .path();
  set.add("trajectory_quaternion", trajectory_quaternion, {kQuaternionOrderNames.begin(), kQuaternionOrderNames.end()},
          "order of its quaternion's columns; auto: from their names or number");
  set.add("start", start, "where in the trajectory to begin, after its first pose [s]").range(0.0);
  set.add("knot_rate", knot_rate, "poses of the trajectory that are used [Hz]; fewer smooth its noise; 0: all")
      .range(0.0, 1e4);
  set.add("scale", scale, "factor on the trajectory's positions").above(0.0);
  set.add("pace", pace, "speed of the motion, [at the beginning, at the end]; [4, 0.5]: the camera slows down")
      .size(2)
      .range(1e-3, 1e3);
  set.add("hold", hold, "spans without any motion [from, to, from, to, ...] [s]");
  set.add("rotation_only", rotation_only, "spans in which the camera only rotates [from, to, ...] [s]");
}

Motion make_motion(const MotionOptions& options, double duration, std::uint64_t seed, const std::string& folder,
                   const std::string& place, std::vector<std::string>* remarks) {
  constexpr double kGap = 2.0 * StoppingClock::kRamp;
  const std::vector<TimeSpan> hold = parse_time_spans(options.hold, place + ".hold", kGap);
  const std::vector<TimeSpan> no_translation =
      merge_time_spans(hold, parse_time_spans(options.rotation_only, place + ".rotation_only", kGap),
                       place + ".hold and .rotation_only", kGap);
  // The position rests in both kinds of spans, the rotation in the first only.
  const StoppingClock rotation_clock(hold), position_clock(no_translation);
  const PaceClock own_time(options.pace, duration);
  const Motion base = base_motion(options, own_time(duration), seed, folder, place, remarks);
  return [base, own_time, rotation_clock, position_clock](double t) {
    return SE3{base(own_time(rotation_clock(t))).q, base(own_time(position_clock(t))).p};
  };
}

PoseTrajectory sample_motion(const Motion& motion, double duration, double rate) {
  const auto count = static_cast<int>(std::floor(duration * rate + 1e-9));
  std::vector<StampedPose> poses;
  for (int i = 0; i <= count; ++i) {
    const double t = i / rate;
    poses.push_back({t, motion(t)});
  }
  return PoseTrajectory(std::move(poses), "simulated ground truth");
}

}  // namespace evbench
