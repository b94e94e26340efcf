#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backends/gp_map/options.hpp"
#include "backends/gp_map/smoother.hpp"
#include "core/smoother/factor_graph.hpp"
#include "core/structure/multi_view.hpp"
#include "core/structure/track_buffer.hpp"

namespace evbench::gp_map {

/// The initial problem of the back-end, with every observation of its landmarks. Its estimates are good initial values.
struct InitialMap {
  FactorGraph graph;            ///< its last state is at the newest state time
  std::vector<TrackId> tracks;  ///< of its landmarks
  double parallax_deg = 0.0;    ///< median over the landmarks, between the first and the last state
};

/// Finds the initial map: candidates from two views (core/structure/initialiser), each refined over some more views
/// (core/structure/multi_view). The best one is taken if the remaining noise allows its structure, even if another one
/// is nearly as good: later data decide (alternative_estimate.hpp). Attempts are rare, because the tracks must have
/// moved farther, and use few points of a track. From the first view's landmarks the trajectory is extended back as far
/// as there are tracks.
///
/// World frame: the camera at the first view. Unit of length: the median distance of its landmarks from there. Gauge
/// and scale are anchored by a tight prior on the first pose, and by the mean nearness to it of that half of the
/// landmarks whose distance is known best.
class InitialMapFinder {
 public:
  InitialMapFinder(const Options& options, const PinholeCamera& camera);

  /// Attempts an initial map with a control state at t, later than those before. `tracks` contain the observations
  /// until t.
  std::optional<InitialMap> attempt(const TrackBuffer& tracks, double t);

  /// Why there is no map: what another attempt needs, and why the last one failed.
  std::string reason() const;

  /// Time of the last state before the initial map; 0 before any.
  double newest() const { return state_times_.empty() ? 0.0 : state_times_.back(); }

 private:
  /// The tracks at an attempt.
  struct Progress {
    double t0 = 0.0, t1 = 0.0;  ///< [s], views
    double motion = 0.0;        ///< [px]
  };

  /// Views of the tracks, and the possible motions between two of them.
  struct Candidates {
    MultiView views;
    std::vector<InitialGuess> guesses;
    PlaceWindow window;  ///< of the views
  };

  std::optional<Candidates> find_candidates(const TrackBuffer& tracks, double t);
  bool worthwhile(const TrackMatches& matches);
  std::optional<ViewsEstimate> best_estimate(const Candidates& candidates) const;
  bool is_sound(const Candidates& candidates, const ViewsEstimate& estimate);
  InitialMap map_of(const TrackBuffer& tracks, const Candidates& candidates, const ViewsEstimate& estimate) const;

  Options options_;
  PinholeCamera camera_;
  Initialiser initialiser_;
  std::optional<Progress> last_;
  std::vector<double> state_times_;
  std::string refused_;  ///< reason of the last attempt
  std::string waiting_ = "no observations";
};

}  // namespace evbench::gp_map
