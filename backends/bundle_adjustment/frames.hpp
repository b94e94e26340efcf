#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/data/track.hpp"

namespace evbench::bundle_adjustment {

/// A feature in a frame: the mean of the track's observations there.
struct Keypoint {
  TrackId track = 0;
  Vector2 pixel = Vector2::Zero();
  double sigma = 1.0;  ///< of the mean [px]
};

/// What a camera with frames would have seen. Its time is the mean time of its observations: the mean place of a
/// feature belongs to the mean time of the observations that made it, not to the middle of the frame.
struct Frame {
  double t = 0.0;
  std::vector<Keypoint> keypoints;  ///< by track; never empty
};

struct FrameRule {
  double duration = 0.05;        ///< [s]; frames follow one another from the first observation on
  int observations = 0;          ///< fixed count instead, when above zero
  double common_noise_px = 0.0;  ///< σ² of a mean = common² + (σ² − common²)⁺/n
};

/// Groups observations into frames.
class FrameBuilder {
 public:
  explicit FrameBuilder(const FrameRule& rule) : rule_(rule) {}

  /// Takes observations in time order; returns the frames that they complete.
  std::vector<Frame> add(std::span<const TrackObservation> observations);

  /// The frame by duration that ends at or before t, all observations up to t having been given.
  std::vector<Frame> advance(double t);

  /// The frame at the end that is not complete, when it has half of what a frame should have.
  std::optional<Frame> rest();

 private:
  FrameRule rule_;
  std::optional<double> start_;  // of the frame that is being gathered
  std::vector<TrackObservation> gathered_;

  Frame close(double end);
};

}  // namespace evbench::bundle_adjustment
