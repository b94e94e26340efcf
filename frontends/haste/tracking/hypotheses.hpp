#pragma once

#include <array>
#include <cstdint>

#include "core/geometry/types.hpp"

namespace evbench::haste {

// The published parameters (Alzugaray and Chli, BMVC 2020, and their code). Those that fix the size of tables are
// constants; the others are TrackerOptions.
inline constexpr int kPatchSize = 31;                ///< a patch is so many cells wide and high
inline constexpr int kPatchRadius = kPatchSize / 2;  ///< from its centre's cell to its border's
inline constexpr int kWindowSize = 193;              ///< events in a tracker's window
inline constexpr int kAngleSteps = 90;               ///< of 4° each make a full turn
inline constexpr double kAngleStep = 2.0 * 3.14159265358979323846 / kAngleSteps;  ///< [rad]

/// Is an event in a tracker's range? dx, dy: from the tracker to the event [px].
constexpr bool in_range(int dx, int dy) { return dx * dx + dy * dy < kPatchRadius * kPatchRadius; }

/// How a hypothesis differs from the present state.
struct Step {
  int x = 0, y = 0;  ///< [px], along the image's axes
  int angle = 0;     ///< in steps of kAngleStep
};
/// The hypotheses, the null hypothesis first. Of two that are equally good the former wins.
inline constexpr int kHypotheses = 11;
inline constexpr std::array<Step, kHypotheses> kSteps{{{0, 0, 0},
                                                       {1, 0, 0},
                                                       {-1, 0, 0},
                                                       {0, 1, 0},
                                                       {0, -1, 0},
                                                       {1, 1, 0},
                                                       {-1, 1, 0},
                                                       {-1, -1, 0},
                                                       {1, -1, 0},
                                                       {0, 0, 1},
                                                       {0, 0, -1}}};

/// Where a tracker is: whole pixels and whole steps of angle. The same as TrackerState, in the tracker's own steps.
struct GridState {
  int x = 0, y = 0;  ///< [px]; may be outside the image
  int angle = 0;     ///< in steps of kAngleStep
  friend GridState operator+(const GridState& a, const Step& b) { return {a.x + b.x, a.y + b.y, a.angle + b.angle}; }
  friend bool operator==(const GridState&, const GridState&) = default;
};

/// A tracker's state in the interface.
struct TrackerState {
  std::int64_t t = 0;                  ///< [µs], that of the window's middle event when the state was reached
  Vector2 position = Vector2::Zero();  ///< of the tracked point, raw [px]
  double angle = 0.0;                  ///< [rad], by which the template is turned, x towards y
};

}  // namespace evbench::haste
