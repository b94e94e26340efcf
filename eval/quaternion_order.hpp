#pragma once

#include <optional>
#include <span>

#include "core/data/pose_file.hpp"
#include "eval/association.hpp"

namespace evbench {

/// The orders in which the quaternions of two files were read. automatic: the file has no quaternions.
struct QuaternionOrders {
  QuaternionOrder ground_truth = QuaternionOrder::automatic, estimate = QuaternionOrder::automatic;
  bool ground_truth_is_assumed = false, estimate_is_assumed = false;  ///< nothing in the file determines it
};

/// Another order of one file's quaternions with which the rotations of both agree.
struct BetterOrder {
  bool of_ground_truth = false;  ///< of the ground truth's quaternions; else of the estimate's
  QuaternionOrder order = QuaternionOrder::automatic;
  bool frames_differ = false;  ///< they agree up to a constant rotation between the two body frames
  double turn_deg = 0.0;       ///< rotation of the ground truth between the compared poses
  double as_read_deg = 0.0;    ///< median difference of the two rotations as the files were read
  double reordered_deg = 0.0;  ///< the same in the other order
};

/// Compares the rotations of the two trajectories between poses (q_i⁻¹ q_j), which do not depend on an alignment. Read
/// in a wrong order, a quaternion has the same angle but another axis. None if no other order fits well and at least
/// four times better, or if the ground truth hardly rotates. `pairs` are not aligned.
std::optional<BetterOrder> better_quaternion_order(std::span<const PosePair> pairs, const QuaternionOrders& read);

}  // namespace evbench
