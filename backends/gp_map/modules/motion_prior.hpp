#pragma once

#include <optional>
#include <span>

#include "backends/gp_map/estimate.hpp"
#include "backends/gp_map/modules/prior_learning.hpp"
#include "backends/gp_map/smoother.hpp"
#include "core/plugin/options.hpp"
#include "core/smoother/time_span.hpp"

namespace evbench::gp_map {

/// When the prior's power spectral density is estimated from the data.
enum class LearnPrior { never, smoothed, always };

/// Parameters that are estimated from the data.
struct LearningOptions {
  LearnPrior prior = LearnPrior::smoothed;
  bool noise = true;
  double window = 0.3, memory = 3.0;
  double interval = 0.3, reach = 1.0, newest = 0.1;
  int rounds = 6;

  void declare(OptionSet& set);
};

/// Estimates the density of the motion prior. Older motion is observed from both sides and shows how smooth it was; the
/// newest motion is observed from one side only and keeps a prior that allows for aggressive motion.
class MotionPrior {
 public:
  explicit MotionPrior(const LearningOptions& options)
      : learn_(options.prior), newest_(options.window, options.memory) {}

  /// learn.prior "always": the newest intervals, too, and future ones.
  void follow(Estimate& estimate);

  /// Intervals in this span; `surplus`: see learn_prior().
  void smooth(Estimate& estimate, const TimeSpan& span, std::span<const double> surplus = {});

  /// Density of the newest interval that was smoothed.
  const std::optional<Vector6>& smoothed() const { return smoothed_; }

 private:
  LearnPrior learn_;
  PriorLearner newest_;
  std::optional<Vector6> smoothed_;
};

}  // namespace evbench::gp_map
