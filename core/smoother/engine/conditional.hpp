#pragma once

#include <span>
#include <vector>

#include "core/smoother/engine/root.hpp"

namespace evbench::smoother {

/// The eliminated variables (pivots) given the variables that remain in the root,
///   Lᵀ δ_p = y − Aᵀ δ_r,
/// with L (p × p, lower) and A (rows of the root × p). Rows of A that belong to pivots or to no variable are zero.
struct Conditional {
  std::vector<int> landmarks;  ///< pivots, in order; after them the state
  std::vector<int> rows;       ///< first row of each pivot variable in the root's layout; a landmark has 3 rows
  int state = -1;              ///< −1: landmarks only
  int pivots = 0;              ///< p
  int extent = 0;              ///< rows of A
  Buffer A, L, y;

  /// Calls visit(first row in the root's layout, size) for each pivot variable.
  template <class Visit>
  void for_each_pivot(Visit visit) const {
    for (std::size_t i = 0; i < landmarks.size(); ++i) visit(rows[i], 3);
    if (state >= 0) visit(rows.back(), pivots - 3 * static_cast<int>(landmarks.size()));
  }

  /// Solves δ_p = L⁻ᵀ (z − Aᵀ δ_r) from the increments in the root's layout and writes it to its rows there.
  void back_substitute(const double* z, double* delta) const;
  /// The same for several right-hand sides, stored by columns with these strides; z becomes δ_p.
  void back_substitute(double* z, int z_stride, double* x, int x_stride, int columns) const;
  /// Eliminates from right-hand sides r in the root's layout: z = L⁻¹ r_p; r_p ← 0; r ← r − A z. All are stored by
  /// columns with these strides.
  void eliminate(double* r, int r_stride, double* z, int z_stride, int columns) const;
};

/// Maximum number of landmarks in one conditional, so that a panel fits into the first-level cache.
inline constexpr int kMaxPivotLandmarks = 8;

/// Eliminates landmarks and, unless −1, a state from the root. Returns −1, or the index of the pivot variable (0, 1,
/// ... in the conditional's order) that made the system singular; the root is then unusable.
int eliminate(Root& root, std::span<const int> landmarks, int state, Conditional& result);

}  // namespace evbench::smoother
