#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "backends/gp_map/options.hpp"
#include "core/data/track.hpp"

namespace evbench::gp_map {

/// Decides at which times control states stand, from the observations and the state before alone, so that a run does
/// not depend on the pieces in which they arrive. The first state stands at the first observation.
///
/// * rate: state k stands k / rate after the first.
/// * observations: at the observation that makes a number of them since the newest state.
/// * motion: at the observation that brings the median displacement of the tracks in the image to a number of pixels,
///   each from its last observation up to the newest state (its first one, for a younger track) to its newest one.
///   Rotation and translation count alike: what the states have to follow is what is seen.
/// * prediction: at the observation that makes most of the landmarks seen since the newest state lie farther from where
///   that state's velocity takes them than a number of sigmas: what a constant velocity does not predict, no
///   interpolation between sparser states follows. It needs a prediction; without one, the greatest spacing.
/// All but rate keep a least and a greatest spacing.
class StatePlacement {
 public:
  /// Distance of an observation from its prediction [sigmas]; none where there is no prediction.
  using Deviation = std::function<std::optional<double>(const TrackObservation&)>;

  explicit StatePlacement(const PlacementOptions& options) : options_(options) {}

  /// What the newest state predicts.
  void predict(Deviation deviation) { deviation_ = std::move(deviation); }

  /// Observations, in the order of their times.
  void observe(const TrackObservation& observation);

  /// The time of the next state, when it is known and ≤ now.
  std::optional<double> next(double now);

  /// The time of the next state if nothing more is observed: it will not stand later.
  double upcoming() const;

  /// The state that closes the trajectory: at or after the last observation. None when there is one already.
  std::optional<double> last();

 private:
  using Rule = PlacementOptions::Rule;

  /// A track's distance from where it was seen last up to the newest state.
  struct Displacement {
    Vector2 from = Vector2::Zero(), to = Vector2::Zero();
    double t = 0.0;  ///< of `to`
  };

  double time_by_data();
  void look_at(const TrackObservation& observation);
  bool is_enough() const;
  double earliest() const { return *newest_ + options_.min_spacing; }
  double latest() const { return *newest_ + std::max(options_.min_spacing, options_.max_spacing); }
  void place(double t);

  PlacementOptions options_;
  std::deque<TrackObservation> later_;             ///< than the newest state, not looked at yet
  std::optional<double> enough_;                   ///< when the data asked for the next state
  int count_ = 0;                                  ///< observations since the newest state, of those looked at
  std::map<TrackId, Displacement> displacements_;  ///< rule "motion"
  Deviation deviation_ = [](const TrackObservation&) { return std::nullopt; };
  std::map<TrackId, bool> deviates_;  ///< rule "prediction": of those seen since the newest state
  int deviating_ = 0;                 ///< how many do
  std::optional<double> first_, newest_;
  std::int64_t placed_ = 0;  ///< states
  std::optional<double> last_observation_;
};

}  // namespace evbench::gp_map
