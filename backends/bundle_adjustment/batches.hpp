#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/data/track.hpp"

namespace evbench::bundle_adjustment {

/// A feature in a batch: the mean of the track's observations there.
struct Keypoint {
  TrackId track = 0;
  Vector2 pixel = Vector2::Zero();
  PixelNoise noise = 1.0;  ///< of the mean
};

/// The observations of one pose, as a camera with frames would have seen them. Its time is the mean time of its
/// observations: the mean position of a feature belongs to the mean time of its observations, not to the middle of the
/// batch.
struct Batch {
  double t = 0.0;
  double end = 0.0;                 ///< [s] when it was complete
  std::vector<Keypoint> keypoints;  ///< by track; never empty
};

/// When a batch is complete. Batches follow one another from the first observation on.
struct BatchRule {
  double duration = 0.05;          ///< [s]
  int observations = 0;            ///< if above zero, it ends with this number instead
  double motion_px = 0.0;          ///< if above zero, it ends with this median motion of its tracks instead
  double shortest_duration = 0.0;  ///< [s] with motion_px; `duration` is then the longest
  double common_noise_px = 0.0;    ///< Σ of a mean = (c + (1 − c)/n) Σ with c = min(1, common²/σ²)
};

/// Groups observations into batches.
class BatchBuilder {
 public:
  explicit BatchBuilder(const BatchRule& rule) : rule_(rule) {}

  /// Adds observations in time order; returns the batches that they complete.
  std::vector<Batch> add(std::span<const UndistortedObservation> observations);

  /// Returns the batches that time completes at or before t. All observations up to t must have been added.
  std::vector<Batch> advance(double t);

  /// The incomplete batch at the end, if it has half of what a batch should have.
  std::optional<Batch> rest();

 private:
  BatchRule rule_;
  std::optional<double> start_;  // of the batch in progress
  std::vector<UndistortedObservation> gathered_;
  struct Shift {
    Vector2 from, to;
  };
  std::map<TrackId, Shift> shifts_;  // of each track in the batch

  void gather(const UndistortedObservation& z);
  bool is_full() const;
  double median_shift() const;
  Batch close(double end);
};

}  // namespace evbench::bundle_adjustment
