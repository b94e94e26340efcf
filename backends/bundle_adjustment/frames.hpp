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
  double end = 0.0;                 ///< [s] when it was complete
  std::vector<Keypoint> keypoints;  ///< by track; never empty
};

/// When a frame is complete. Frames follow one another from the first observation on.
struct FrameRule {
  double duration = 0.05;          ///< [s]
  int observations = 0;            ///< this many instead, when above zero
  double motion_px = 0.0;          ///< when above zero, the tracks' median motion in the frame instead
  double shortest_duration = 0.0;  ///< [s] with motion_px; `duration` is then the longest
  double common_noise_px = 0.0;    ///< σ² of a mean = common² + (σ² − common²)⁺/n
};

/// Groups observations into frames.
class FrameBuilder {
 public:
  explicit FrameBuilder(const FrameRule& rule) : rule_(rule) {}

  /// Takes observations in time order; returns the frames that they complete.
  std::vector<Frame> add(std::span<const TrackObservation> observations);

  /// The frame that time completes at or before t, all observations up to t having been given.
  std::vector<Frame> advance(double t);

  /// The frame at the end that is not complete, when it has half of what a frame should have.
  std::optional<Frame> rest();

 private:
  FrameRule rule_;
  std::optional<double> start_;  // of the frame that is being gathered
  std::vector<TrackObservation> gathered_;
  struct Shift {
    Vector2 from, to;
  };
  std::map<TrackId, Shift> shifts_;  // of each track in the frame

  void gather(const TrackObservation& z);
  bool is_full() const;
  double median_shift() const;
  Frame close(double end);
};

}  // namespace evbench::bundle_adjustment
