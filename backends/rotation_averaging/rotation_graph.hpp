#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/geometry/types.hpp"

namespace evbench {

/// A relative rotation between two times, R_left_right, with its weight (inverse variance [1/rad²]).
struct RotationEdge {
  std::size_t left = 0, right = 0;
  Eigen::Quaterniond R;
  double weight = 1.0;
};

/// A rotation that takes the directions `right` to the directions `left` (unit vectors, pairs), and its residual.
struct AlignedDirections {
  Eigen::Quaterniond R;
  double residual = 0.0;  ///< [rad] root mean square, weighted
  double weight = 0.0;    ///< sum of the weights: effective number of pairs
};

/// By least squares (Kabsch 1976) with Cauchy weights of this scale [rad]; none for fewer than two pairs.
std::optional<AlignedDirections> align_directions(std::span<const std::pair<Vector3, Vector3>> left_and_right,
                                                  double scale);

/// The rotations that agree best with the edges: minimises Σ w ρ(|Log(R_edgeᵀ R_leftᵀ R_right)|) by Gauss-Newton steps
/// with Cauchy's loss ρ of `scale` [rad] (rotation averaging, Hartley et al. 2013). `rotations` are the initial values;
/// the first one is held.
void average_rotations(std::span<const RotationEdge> edges, double scale, std::vector<Eigen::Quaterniond>& rotations);

}  // namespace evbench
