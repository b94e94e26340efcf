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

/// What an event camera's silence says. A pixel that sees no change makes no event, so that a front-end has nothing to
/// tell of a camera at rest; but a track that is neither observed nor ended is still where it was, to within the step
/// of a tracker. When for a while no track has been observed and enough are alive, each is therefore observed again at
/// its last place: every back-end then holds its estimate, with whatever model it has, and none is lost. A silence is
/// one that is long beside the usual time between observations, so that tracks of slow frames are not taken for it.
///
/// A sensor that told nothing while the camera moved looks the same, until it tells again: then most tracks end at
/// once, as what they were on is elsewhere. Such a stand is taken back.
class StationaryDetector {
 public:
  /// `after` [s] without any observation; 0: never.
  explicit StationaryDetector(double after) : after_(after) {}

  /// Takes a batch in undistorted pixels, and adds the observations that silence stands for.
  void apply(TrackBatch& batch);

  std::size_t tracks() const { return live_.size(); }  ///< alive

  /// The camera stands still at the last batch's end.
  bool holds() const { return still_; }
  const std::vector<StationaryPeriod>& spans() const { return spans_; }

  /// A stand that was none, and the tracks that were held in it and have not ended: they may be on something else.
  struct Refuted {
    StationaryPeriod span;
    std::set<TrackId> survivors;
  };
  /// Shown by the last batch; of several the first. It is one of `spans` until the next batch comes: at the end of the
  /// data all tracks end, which shows nothing.
  const std::optional<Refuted>& refuted() const { return refuted_; }

 private:
  void begin_stand(double t);
  void hold(double until, std::vector<TrackObservation>& observations);
  void remember(const TrackObservation& z);
  void forget(const TrackEnd& ended);
  void doubt();

  double after_;
  std::map<TrackId, TrackObservation> live_;  ///< the last observation of each track that has not ended
  double last_ = 0.0;                         ///< [s] of the last observation of any
  double usual_ = 0.0;                        ///< [s], longest time between two observations of late
  std::int64_t held_ = 0;                     ///< times that the tracks were held since
  bool still_ = false;
  std::vector<StationaryPeriod> spans_;

  std::set<TrackId> held_tracks_;     ///< in the last stand, that have not ended since
  std::size_t stood_ = 0;             ///< how many were held
  std::vector<double> gone_at_;       ///< [s], of these, those that have ended about when something was seen again
  std::optional<double> seen_again_;  ///< [s], first observation since that stand
  std::optional<Refuted> refuted_;
};

}  // namespace evbench
