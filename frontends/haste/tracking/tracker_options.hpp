#pragma once

namespace evbench::haste {

/// How the hypotheses are scored. The names are the published ones.
enum class Variant {
  correlation,             ///< 3DV 2019: events weighted by age, the whole window sampled again at each event
  haste_correlation,       ///< an event is sampled once, when it comes, and again at a change of state
  haste_correlation_star,  ///< all events weigh the same, so that a score changes by the newest and the oldest only
  haste_difference,        ///< squared difference between template and window instead of their correlation
  haste_difference_star,   ///< the same with the template as it was at the last change of state
};

/// Options of a tracker; the defaults are those of the published code.
struct TrackerOptions {
  Variant variant = Variant::haste_correlation_star;
  /// The state changes when (best − null) / (best − worst) of the scores is above this.
  double change_threshold = 0.05;
  /// What the window's middle event adds to the template at each event, as a part of what it added at the start.
  double template_learning = 0.1;
};

}  // namespace evbench::haste
