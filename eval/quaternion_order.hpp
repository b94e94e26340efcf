#pragma once

#include <optional>
#include <span>

#include "core/data/pose_file.hpp"
#include "eval/association.hpp"

namespace evbench {

/// How two files were read. automatic: the file has no quaternion whose order may be another.
struct QuaternionOrders {
  QuaternionOrder ground_truth = QuaternionOrder::automatic, estimate = QuaternionOrder::automatic;
  bool ground_truth_is_assumed = false, estimate_is_assumed = false;  ///< as nothing in the file tells the order
};

/// Another order of one file's quaternions, with which both turn alike.
struct BetterOrder {
  bool of_ground_truth = false;  ///< whose order it is; else the estimate's
  QuaternionOrder order = QuaternionOrder::automatic;
  bool frames_differ = false;  ///< they turn alike but for a rotation between the two bodies' frames
  double turn_deg = 0.0;       ///< by how much the ground truth turns between the compared poses
  double as_read_deg = 0.0;    ///< median difference of the two turns as the files were read
  double reordered_deg = 0.0;  ///< and in the other order
};

/// Compares how the two trajectories turn between poses (q_i⁻¹ q_j), which does not depend on an alignment. In a wrong
/// order a quaternion is still one, and turns by the same angle, but about another axis. None where another order does
/// not fit at least four times better, where it does not fit well, and where the ground truth hardly turns. `pairs` are
/// not aligned.
std::optional<BetterOrder> better_quaternion_order(std::span<const PosePair> pairs, const QuaternionOrders& read);

}  // namespace evbench
