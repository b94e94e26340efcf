#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/data/track.hpp"
#include "core/plugin/options.hpp"

namespace evbench::gp_map {

/// When a control state is placed.
struct PlacementOptions {
  enum class Rule { rate, observations, motion, prediction } rule = Rule::prediction;
  double rate = 20.0;
  int observations = 100;
  double motion = 2.0;
  double deviation = 3.0;
  double min_spacing = 0.005, max_spacing = 0.05;

  void declare(OptionSet& set);
};

/// Decides the times of control states from the observations and the state before alone, so that a run does not depend
/// on how observations are split into batches. The first state is at the first observation.
///
/// * rate: state k is k / rate after the first.
/// * observations: at the observation that completes a number of them since the newest state.
/// * motion: at the observation at which the median displacement of the tracks in the image reaches a number of pixels.
///   A track's displacement is from its last observation up to the newest state (its first one, for a later track) to
///   its newest one. Rotation and translation count alike, because the states have to follow the motion in the image.
/// * prediction: at the observation at which most of the landmarks seen since the newest state are farther than a
/// number
///   of sigmas from their prediction with that state's velocity. Interpolation between sparser states cannot follow a
///   motion that constant velocity does not predict. Without a prediction the spacing is the greatest.
/// All but rate keep a least and a greatest spacing.
class StatePlacement {
 public:
  /// Distance of an observation from its prediction [sigmas]; none where there is no prediction.
  using Deviation = std::function<std::optional<double>(const UndistortedObservation&)>;

  explicit StatePlacement(const PlacementOptions& options) : options_(options) {}

  /// Sets the prediction of the newest state.
  void predict(Deviation deviation) { deviation_ = std::move(deviation); }

  /// Observations come in the order of their times.
  void observe(const UndistortedObservation& observation);

  /// The time of the next state, if it is known and ≤ now.
  std::optional<double> next(double now);

  /// The time of the next state without further observations, which is the latest possible one.
  double upcoming() const;

  /// The state that closes the trajectory: at or after the last observation. None if there is one already.
  std::optional<double> last();

 private:
  using Rule = PlacementOptions::Rule;

  /// A track's displacement since its last observation up to the newest state.
  struct Displacement {
    Vector2 from = Vector2::Zero(), to = Vector2::Zero();
    double t = 0.0;  ///< of `to`
  };

  double time_by_data();
  void consider(const UndistortedObservation& observation);
  bool is_enough() const;
  double earliest() const { return *newest_ + options_.min_spacing; }
  double latest() const { return *newest_ + std::max(options_.min_spacing, options_.max_spacing); }
  void place(double t);

  PlacementOptions options_;
  std::deque<UndistortedObservation> later_;       ///< than the newest state, not considered yet
  std::optional<double> enough_;                   ///< [s] when the data require the next state
  int count_ = 0;                                  ///< considered observations since the newest state
  std::map<TrackId, Displacement> displacements_;  ///< rule "motion"
  Deviation deviation_ = [](const UndistortedObservation&) { return std::nullopt; };
  std::map<TrackId, bool> deviates_;  ///< rule "prediction": tracks seen since the newest state
  int deviating_ = 0;                 ///< how many of these deviate
  std::optional<double> first_, newest_;
  std::int64_t placed_ = 0;  ///< states
  std::optional<double> last_observation_;
};

}  // namespace evbench::gp_map
