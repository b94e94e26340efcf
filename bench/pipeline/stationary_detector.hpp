#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "core/plugin/exchange.hpp"

namespace evbench {

/// A span of sequence time [s].
struct StationaryPeriod {
  double from = 0.0, to = 0.0;
};

/// Detects stationary periods of an event camera and keeps back-ends from losing track during them. A camera at rest
/// causes no events, so the front-end has no observations; but a track that is neither observed nor ended is still at
/// its last position, to within the step of a tracker. When no track has been observed for some time and enough are
/// alive, each is therefore observed again at its last position: a back-end with any motion model keeps its estimate.
/// The time must be long compared with the usual interval between observations, so that a slow front-end does not
/// trigger it.
///
/// A sensor that fails while the camera moves cannot be distinguished at first. When its data return, most tracks end
/// at once, because their scene points have moved. Such a stationary period is rejected.
class StationaryDetector {
 public:
  /// `after` [s] without any observation; 0: never.
  explicit StationaryDetector(double after) : after_(after) {}

  /// Processes a batch (undistorted pixels) and adds the repeated observations of a stationary period.
  void apply(UndistortedBatch& batch);

  std::size_t tracks() const { return live_.size(); }  ///< number of live tracks

  /// Whether the camera is stationary at the last batch's end.
  bool is_stationary() const { return is_stationary_; }
  const std::vector<StationaryPeriod>& periods() const { return periods_; }

  /// A stationary period during which the camera moved, and the repeated tracks that have not ended since: they may
  /// have drifted to other scene points.
  struct Rejected {
    StationaryPeriod period;
    std::set<TrackId> surviving_tracks;
  };
  /// Set by the last batch; of several periods the first. The period stays in periods() until the next batch: at the
  /// end of the data all tracks end, which is no evidence of motion.
  const std::optional<Rejected>& rejected() const { return rejected_; }

 private:
  void begin_period(double t);
  void repeat_tracks(double until, std::vector<UndistortedObservation>& observations);
  void on_observation(const UndistortedObservation& z);
  void on_end(const TrackEnd& ended);
  void check_period();

  double after_;
  std::map<TrackId, UndistortedObservation> live_;  ///< the last observation of each track that has not ended
  double last_ = 0.0;                               ///< [s] of the last observation of any track
  double usual_interval_ = 0.0;                     ///< [s], longest recent time between two observations
  std::int64_t repetitions_ = 0;                    ///< of the tracks since the last observation
  bool is_stationary_ = false;
  std::vector<StationaryPeriod> periods_;

  std::set<TrackId> repeated_tracks_;  ///< of the last stationary period, those that have not ended since
  std::size_t repeated_count_ = 0;     ///< number of tracks when that period began
  std::vector<double> ended_at_;       ///< [s], ends of these tracks close to the first observation after the period
  std::optional<double> seen_again_;   ///< [s], first observation after that period
  std::optional<Rejected> rejected_;
};

}  // namespace evbench
