#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backends/gp_map/factor_graph.hpp"
#include "backends/gp_map/options.hpp"
#include "core/structure/track_buffer.hpp"

namespace evbench::gp_map {

/// The problem that the back-end starts from, solved over every observation of its landmarks.
struct FirstMap {
  FactorGraph graph;            ///< its last state stands at the newest state time
  std::vector<TrackId> tracks;  ///< of its landmarks
  double cost = 0.0;            ///< per observation
  double parallax_deg = 0.0;    ///< median over the landmarks, between the first and the last state
};

/// Finds the first map: guesses from two views (core/structure/initialiser), each refined as the whole continuous-time
/// problem, the cheapest of them when the data decide between them.
///
/// World frame: the camera at the first state. Unit of length: the median depth from the guess's first view. Gauge and
/// scale are anchored there, by a tight prior on the first pose and the mean log distance of the landmarks.
class FirstMapFinder {
 public:
  FirstMapFinder(const Options& options, const PinholeCamera& camera);

  /// A control state stands at t, later than those before; `tracks` hold the observations up to there.
  std::optional<FirstMap> attempt(const TrackBuffer& tracks, double t);

  /// Why the last attempt was vain.
  const std::string& reason() const { return reason_; }

  /// Of the last state before the first map; 0 before any.
  double newest() const { return state_times_.empty() ? 0.0 : state_times_.back(); }

 private:
  std::optional<FirstMap> refine(const TrackBuffer& tracks, const InitialGuess& guess) const;
  std::vector<double> state_times_from(double start) const;
  double start_time(const TrackBuffer& tracks, const InitialGuess& guess) const;

  Options options_;
  PinholeCamera camera_;
  Initialiser initialiser_;
  std::vector<double> state_times_;
  std::string reason_;
};

}  // namespace evbench::gp_map
