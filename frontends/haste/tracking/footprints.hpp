#pragma once

#include <array>
#include <cstdint>

#include "core/support/index.hpp"
#include "frontends/haste/tracking/hypotheses.hpp"

namespace evbench::haste {

/// Patches are stored row by row with one empty cell after each row.
inline constexpr int kPatchStride = kPatchSize + 1;
inline constexpr int kPatchCells = kPatchSize * kPatchStride;
constexpr int patch_cell(int x, int y) { return y * kPatchStride + x; }

/// An event's weights in the four cells around it have this sum: integers, so that sums of them are exact in any order.
inline constexpr int kUnit = 1024;

/// An event's position in a patch: bilinear weights of the cells (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1) around
/// it, rounded to 1/32 of a cell.
struct Footprint {
  int cell = 0;                  ///< patch_cell(x, y)
  std::array<int, 4> weights{};  ///< sum kUnit; all zero outside the patch
  bool inside() const { return weights[0] + weights[1] + weights[2] + weights[3] != 0; }
};

/// The footprint of an event that is (dx, dy) px from the middle of a patch which is turned by so many steps (BMVC
/// 2020, Section 3). Inside is where each coordinate is at least 0 and less than kPatchSize − 1: the published rule.
Footprint footprint(int dx, int dy, int angle);

/// The footprints of all events that can fall into a patch, for one angle.
class Footprints {
 public:
  /// The largest distance along each axis [px] at which an event can be in the patch of one of a tracker's hypotheses.
  static constexpr int kReach = 22;

  /// The table's rows and columns: a tracker's neighbours see one more.
  static constexpr int kSide = 2 * kReach + 3;

  /// The table of an angle, in steps; all are made at the first call.
  static const Footprints& of(int angle);

  /// The index of an event (dx, dy) px from the tracker; out of reach, an index that is in no hypothesis' patch.
  static constexpr int place(int dx, int dy) {
    const bool reached = dx >= -kReach && dx <= kReach && dy >= -kReach && dy <= kReach;
    return reached ? (dy + kReach + 1) * kSide + (dx + kReach + 1) : kSide + 1;
  }
  /// Added to an event's index, this gives its index as seen from a tracker that is moved by a step.
  static constexpr int shift(const Step& step) { return -(step.y * kSide + step.x); }

  /// Places [begin, end) of a row of the table: outside of them nothing is inside the patch.
  struct Run {
    int begin = 0, end = 0;
  };
  const auto& runs() const { return runs_; }

  int cell(int place) const { return cells_[index(place)]; }
  const std::array<int, 4>& weights(int place) const { return weights_[index(place)]; }

 private:
  explicit Footprints(int angle);

  std::array<std::int16_t, kSide * kSide> cells_{};
  alignas(16) std::array<std::array<int, 4>, kSide * kSide> weights_{};
  std::array<Run, kSide> runs_{};
};

}  // namespace evbench::haste
