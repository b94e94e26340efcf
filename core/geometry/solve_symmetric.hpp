#pragma once

#include <Eigen/Core>

namespace evbench {

/// A symmetric system of at most 12 unknowns, stored without allocation.
using SmallSystem = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 12, 12>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 12, 1>;

/// Solves H x = g for a symmetric, positive semi-definite H (normal equations) by LDLᵀ with pivoting. The result is not
/// finite if H or g is not. Compiled once for all sizes, because Eigen's fixed-size decompositions take seconds to
/// compile in each source.
SmallVector solve_symmetric(const SmallSystem& H, const SmallVector& g);

}  // namespace evbench
