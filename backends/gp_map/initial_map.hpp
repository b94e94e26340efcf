#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backends/gp_map/factor_graph.hpp"
#include "backends/gp_map/options.hpp"
#include "core/structure/multi_view.hpp"
#include "core/structure/track_buffer.hpp"

namespace evbench::gp_map {

/// The problem that the back-end starts from, with every observation of its landmarks; its estimates are good guesses.
struct InitialMap {
  FactorGraph graph;            ///< its last state stands at the newest state time
  std::vector<TrackId> tracks;  ///< of its landmarks
  double parallax_deg = 0.0;    ///< median over the landmarks, between the first and the last state
};

/// Finds the initial map: guesses from two views (core/structure/initialiser), each refined over some views more
/// (core/structure/multi_view). The best one is taken when the noise that is left allows its structure, even where
/// another one is nearly as good: what is seen later tells (recent_hypothesis.hpp). Attempts are rare, as the tracks
/// must have moved farther, and look at few places of a track. From the first view's landmarks the trajectory reaches
/// back as far as there are tracks.
///
/// World frame: the camera at the first view. Unit of length: the landmarks' median distance from there. Gauge and
/// scale are anchored by a tight prior on the first pose and the mean nearness to it of those landmarks, half of them,
/// whose distance is known best.
class InitialMapFinder {
 public:
  InitialMapFinder(const Options& options, const PinholeCamera& camera);

  /// A control state stands at t, later than those before; `tracks` hold the observations up to there.
  std::optional<InitialMap> attempt(const TrackBuffer& tracks, double t);

  /// A control state stands at t, likewise, where no map is looked for.
  void pass(double t) { state_times_.push_back(t); }

  /// The last map was none: another one is looked for from the next view on.
  void reinitialise();

  /// Why there is none: what it would have taken to make another attempt, and why the last one was vain.
  std::string reason() const;

  /// Of the last state before the initial map; 0 before any.
  double newest() const { return state_times_.empty() ? 0.0 : state_times_.back(); }

 private:
  /// What tracks had shown at an attempt.
  struct Progress {
    double t0 = 0.0, t1 = 0.0;  ///< [s], views
    double motion = 0.0;        ///< [px]
  };

  /// Views of the tracks, and what two of them may mean.
  struct Look {
    MultiView views;
    std::vector<InitialGuess> guesses;
    PlaceWindow window;  ///< of the views
  };

  std::optional<Look> look_at(const TrackBuffer& tracks, double t);
  bool worthwhile(const TrackMatches& matches);
  std::optional<ViewsEstimate> explanation(const Look& look) const;
  bool is_sound(const Look& look, const ViewsEstimate& explained);
  InitialMap map_of(const TrackBuffer& tracks, const Look& look, const ViewsEstimate& explained) const;

  Options options_;
  PinholeCamera camera_;
  Initialiser initialiser_;
  std::optional<Progress> last_;
  std::vector<double> state_times_;
  std::string refused_;  ///< by the last attempt
  std::string waiting_ = "no observations";
};

}  // namespace evbench::gp_map
