#pragma once

#include <Eigen/Core>

namespace evbench {

/// A symmetric system of at most 12 unknowns, which is kept without allocating.
using SmallSystem = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 12, 12>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 12, 1>;

/// The x of H x = g for a symmetric, positive semi-definite H (normal equations), by LDLᵀ with pivoting. Not finite
/// where H or g is not. Compiled once for all sizes: Eigen's decompositions of fixed sizes cost each source that uses
/// one seconds of compiling.
SmallVector solve_symmetric(const SmallSystem& H, const SmallVector& g);

}  // namespace evbench
