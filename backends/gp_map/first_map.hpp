#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "backends/gp_map/factor_graph.hpp"
#include "backends/gp_map/options.hpp"
#include "core/structure/multi_view.hpp"
#include "core/structure/track_buffer.hpp"

namespace evbench::gp_map {

/// The problem that the back-end starts from, with every observation of its landmarks; its estimates are good guesses.
struct FirstMap {
  FactorGraph graph;            ///< its last state stands at the newest state time
  std::vector<TrackId> tracks;  ///< of its landmarks
  double parallax_deg = 0.0;    ///< median over the landmarks, between the first and the last state
};

/// Finds the first map: guesses from two views (core/structure/initialiser), each refined over some views more
/// (core/structure/multi_view). The best one is taken when it is significantly better than all others and the noise
/// that is left allows its structure. Attempts are rare, as the tracks must have moved farther, and look at few places
/// of a track. From the first view's landmarks the trajectory reaches back as far as there are tracks.
///
/// For a while a map is looked at again: what is seen later may tell that another explanation was the true one.
///
/// World frame: the camera at the first view. Unit of length: the landmarks' median distance from there. Gauge and
/// scale are anchored by a tight prior on the first pose and the mean nearness to it of those landmarks, half of them,
/// whose distance is known best.
class FirstMapFinder {
 public:
  FirstMapFinder(const Options& options, const PinholeCamera& camera);

  /// A control state stands at t, later than those before; `tracks` hold the observations up to there.
  std::optional<FirstMap> attempt(const TrackBuffer& tracks, double t);

  /// What a present map says about the time between two views.
  using Present = std::function<InitialGuess(double t0, double t1)>;

  /// As attempt(), with a present map: another one when that explains the tracks significantly better.
  std::optional<FirstMap> reconsider(const TrackBuffer& tracks, double t, const Present& present);

  /// Whether the map has been looked at often enough.
  bool settled() const { return looks_ >= kLooks; }

  /// Why the last attempt was vain.
  const std::string& reason() const { return reason_; }

  /// Of the last state before the first map; 0 before any.
  double newest() const { return state_times_.empty() ? 0.0 : state_times_.back(); }

 private:
  static constexpr int kLooks = 10;

  /// What tracks had shown at an attempt.
  struct Progress {
    double t0 = 0.0, t1 = 0.0;  ///< [s], views
    double motion = 0.0;        ///< [px]
  };

  /// Views of the tracks, and what two of them may mean.
  struct Look {
    MultiView views;
    std::vector<InitialGuess> guesses;
  };

  std::optional<Look> look_at(const TrackBuffer& tracks, double t);
  bool worthwhile(const TrackMatches& matches) const;
  std::vector<ViewsExplained> explanations(const MultiView& views, const std::vector<InitialGuess>& guesses) const;
  bool is_sound(const MultiView& views, const ViewsExplained& explained);
  bool is_clear(const MultiView& views, const std::vector<ViewsExplained>& found);
  FirstMap map_of(const TrackBuffer& tracks, const MultiView& views, const ViewsExplained& explained) const;

  Options options_;
  PinholeCamera camera_;
  Initialiser initialiser_;
  std::optional<Progress> last_;
  int looks_ = 0;
  std::vector<double> state_times_;
  std::string reason_;
};

}  // namespace evbench::gp_map
