#include "backends/gp_map/modules/motion_prior.hpp"

namespace evbench::gp_map {

void LearningOptions::declare(OptionSet& set) {
  set.add("prior", prior, {"never", "smoothed", "always"},
          "when the prior's power spectral density is estimated from the data, beginning with qc: never; smoothed: "
          "where motion is observed from both sides, while running for all but the newest, and for the final estimate "
          "from all data; always: also for the newest motion, which can lose the scale where landmarks live for less "
          "than a second or the motion is aggressive");
  set.add("noise", noise,
          "estimate a scale of the observations' sigmas, one more for each track that is noisier than most, and the "
          "share of their information that counts, because trackers drift");
  set.add("window", window,
          "while running, the prior follows the data of this time; after aggressive motion a relaxed prior recovers "
          "in a few times this [s]")
      .range(0.01, 100.0);
  set.add("memory", memory,
          "where those data determine little, the prior follows the data of this longer time; so does the noise; while "
          "running, a track's own noise is estimated until the track has this age [s]")
      .range(0.1, 1000.0);
  set.add("interval", interval, "time between smoothed estimates while running [s]").range(0.01, 100.0);
  set.add("reach", reach, "how far these reach back [s]").range(0.1, 100.0);
  set.add("newest", newest, "newer motion is left out of them: it is observed from one side only [s]").range(0.0, 10.0);
  set.add("rounds", rounds, "rounds of estimating prior and noise in the final estimate").range(0, 100);
}

void MotionPrior::follow(Estimate& estimate) {
  if (learn_ == LearnPrior::always) newest_.follow(estimate.smoother);
}

void MotionPrior::smooth(Estimate& estimate, const TimeSpan& span, std::span<const double> surplus) {
  if (learn_ == LearnPrior::never) return;
  learn_prior(estimate.smoother, span, surplus);
  if (span.is_everything()) return;  // the final density is recorded beside this one
  const int k = estimate.graph().first_state_after(span.until) - 1;
  if (k > estimate.smoother.first_state()) smoothed_ = estimate.graph().qcs[index(k)];
}

}  // namespace evbench::gp_map
