#pragma once

#include <array>

#include "frontends/haste/tracking/footprints.hpp"

namespace evbench::haste {

/// What a tracker looks for: how many events there are in each cell of a patch that moves and turns with the tracked
/// point, which is in the middle. A value; a tracker's can be copied, kept, and given to another.
class Template {
 public:
  /// The events in a cell; x and y from 0 to kPatchSize − 1.
  float at(int x, int y) const { return cells_[index(patch_cell(x, y))]; }
  /// Of all cells.
  double mass() const { return mass_; }
  const std::array<float, kPatchCells>& cells() const { return cells_; }  ///< by patch_cell

  /// Spreads so much of an event over the four cells around its place; nothing if that is outside the patch.
  void add(const Footprints& footprints, int place, float weight);

  /// The same template turned by `angle` [rad] (x towards y) and magnified by `scale` about the middle, its mass as
  /// before; what comes in from outside the patch is empty. For a point that is seen again from elsewhere.
  Template warped(double angle, double scale) const;

 private:
  std::array<float, kPatchCells> cells_{};
  double mass_ = 0.0;
};

}  // namespace evbench::haste
