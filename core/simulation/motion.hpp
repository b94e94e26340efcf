#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/data/pose_file.hpp"
#include "core/motion/pose_trajectory.hpp"
#include "core/plugin/options.hpp"

namespace evbench {

/// T_world_camera at any time t [s] from 0 to the sequence's end; pose, velocity and acceleration are continuous.
using Motion = std::function<SE3(double t)>;

struct MotionOptions {
  std::string kind = "robot_arm";
  double amplitude = 0.3;
  double rotation_amplitude = 0.15;
  double max_frequency = 0.5;
  double period = 6.0;
  double distance = 1.5;
  std::string trajectory;
  QuaternionOrder trajectory_quaternion = QuaternionOrder::automatic;
  double start = 0.0;
  double knot_rate = 20.0;
  double scale = 1.0;
  std::vector<double> pace = {1.0, 1.0};
  std::vector<double> hold, rotation_only;

  void declare(OptionSet& set);
};

/// A motion of the given kind:
/// - smooth_random: position and rotation vector are sums of three sinusoids an axis, none faster than max_frequency;
/// - robot_arm: a closed path (a tilted figure with ratios 1:1:2) that repeats every period, the camera turned to a
///   point at `distance` in front of the path's centre, with a gentle roll;
/// - trajectory: the poses of a file (relative to `folder`), sampled at knot_rate and joined by a spline (PoseSpline).
///   The spline is not the motion model of a back-end, which it would favour.
/// `pace` is the speed at which a motion is run through: it changes from its first value to its second over the
/// sequence, by the same factor each second.
/// Throws InputError, naming `place`, when a trajectory file is missing, too short for `duration` [s], or damaged. What
/// was assumed about it, and that its poses are far apart, is added to `remarks`, if they are given.
Motion make_motion(const MotionOptions& options, double duration, std::uint64_t seed, const std::string& folder,
                   const std::string& place, std::vector<std::string>* remarks = nullptr);

/// The motion sampled at `rate` [Hz] over [0, duration].
PoseTrajectory sample_motion(const Motion& motion, double duration, double rate);

}  // namespace evbench
