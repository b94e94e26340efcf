#pragma once

#include <array>

#include "frontends/haste/tracking/footprints.hpp"

namespace evbench::haste {

/// The pattern that a tracker follows: the number of events in each cell of a patch that moves and turns with the
/// tracked point, which is in the middle. A value type: a tracker's template can be copied, stored and given to another
/// tracker.
class Template {
 public:
  /// The number of events in a cell; x and y from 0 to kPatchSize − 1.
  float at(int x, int y) const { return cells_[index(patch_cell(x, y))]; }
  /// The sum of all cells.
  double mass() const { return mass_; }
  const std::array<float, kPatchCells>& cells() const { return cells_; }  ///< by patch_cell

  /// Adds an event with this weight to the four cells around it; nothing if it is outside the patch.
  void add(const Footprints& footprints, int place, float weight);

  /// The template turned by `angle` [rad] (x towards y) and magnified by `scale` about the middle, with the same mass.
  /// Cells that come in from outside the patch are empty. For a point that is seen again from another pose.
  Template warped(double angle, double scale) const;

 private:
  std::array<float, kPatchCells> cells_{};
  double mass_ = 0.0;
};

}  // namespace evbench::haste
