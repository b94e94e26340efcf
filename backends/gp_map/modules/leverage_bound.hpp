#pragma once

#include "backends/gp_map/estimate.hpp"
#include "core/plugin/options.hpp"

namespace evbench::gp_map {

struct LeverageOptions {
  bool enabled = true;
  double nearness = 3.0;
  double most = 100.0;

  void declare(OptionSet& set);
};

/// Bounds the influence of one landmark on the estimate of the camera's position.
///
/// The effect of a translation on the image grows with nearness. A track that follows nothing, taken for a landmark
/// close to the camera, has more influence on the translation than all others together, and the estimate then fits it.
/// A robust loss depends on residuals and does not protect against such leverage. Larger sigmas bound it, as Mallows'
/// estimators do, and leave residuals by which such a track is recognised. Sigmas in proportion to nearness do not
/// suffice: translation and rotation move everything at the same distance by nearly the same amount, so a few near
/// landmarks decide between the two.
class LeverageBound {
 public:
  explicit LeverageBound(const LeverageOptions& options) : options_(options) {}

  /// Updates the factors of the landmarks in the newest interval.
  void apply(Estimate& estimate) const;

 private:
  LeverageOptions options_;
};

}  // namespace evbench::gp_map
