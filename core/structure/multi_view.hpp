#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/structure/initialiser.hpp"
#include "core/structure/point_image.hpp"

namespace evbench {

/// Where tracks were at some times: what decides between the explanations of two of these views.
struct TrackViews {
  std::vector<double> times;
  std::vector<TrackId> tracks;
  std::vector<std::vector<std::optional<Vector2>>> places;  ///< [px] by track, by time
  double sigma = 0.0;                                       ///< [px] of one observation, median over the tracks

  /// Those with a place in at least three of them; no more than `most`, those with most places.
  static TrackViews of(const TrackBuffer& tracks, std::vector<double> times, const PlaceWindow& window,
                       std::size_t most);
};

/// Poses and points that explain the views. The world is the camera at the first one.
struct ViewsExplained {
  std::vector<SE3> poses;            ///< T_world_camera, by view; unit of length: the points' median distance
  std::vector<InversePoint> points;  ///< by track
  double width = 0.0;                ///< [px] of the loss
  double cost = 0.0;                 ///< Σ of the loss over all places [px²]
};

/// Bundle adjustment of some views from the guesses that two of them give: Levenberg-Marquardt on the reprojection
/// errors, the points eliminated first. The loss is bounded: what is far off counts the same wherever it is. Every
/// track is in every explanation, whether the guess had it or not, so that costs can be compared.
class MultiView {
 public:
  MultiView(TrackViews views, const PinholeCamera& camera) : views_(std::move(views)), camera_(camera) {}

  const TrackViews& views() const { return views_; }

  /// The guess, continued to all views. None where that fails.
  std::optional<ViewsExplained> start(const InitialGuess& guess, double width) const;

  /// At most so many iterations, fewer when the cost ceases to fall.
  void refine(ViewsExplained& explained, double width, int iterations) const;

  /// How uncertain the structure is: by track, the standard deviation of a distance's logarithm, the distance measured
  /// in the length of the longest baseline, under noise as large as the errors that are left, and no smaller than half
  /// an observation's sigma: what drifts along a track shows in no residual. Infinite without a baseline.
  std::vector<double> distance_sigmas(const ViewsExplained& explained) const;

  /// Mean reprojection error [px], by track.
  std::vector<double> errors(const ViewsExplained& explained) const;

 private:
  class Step;

  /// Of a track's places, those behind the camera far off [px²].
  std::vector<double> squared_errors(const ViewsExplained& explained, std::size_t track) const;
  void take_cost(ViewsExplained& explained) const;

  TrackViews views_;
  PinholeCamera camera_;
};

}  // namespace evbench
