#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/structure/initialiser.hpp"
#include "core/structure/point_image.hpp"

namespace evbench {

/// Positions of tracks in several views, to decide between the two-view candidates of two of them.
struct TrackViews {
  std::vector<double> times;
  std::vector<TrackId> tracks;
  std::vector<std::vector<std::optional<Vector2>>> places;  ///< [px] by track, by time
  double sigma = 0.0;                                       ///< [px] of one observation, median over the tracks

  /// The tracks with a position in at least three views; at most `most`, those with most positions first.
  static TrackViews of(const TrackBuffer& tracks, std::vector<double> times, const PlaceWindow& window,
                       std::size_t most);
};

/// Estimate of poses and points from several views. The world is the camera of the first view.
struct ViewsEstimate {
  std::vector<SE3> poses;            ///< T_world_camera, by view; unit of length: the points' median distance
  std::vector<InversePoint> points;  ///< by track
  double width = 0.0;                ///< [px] of the loss
  double cost = 0.0;                 ///< Σ of the loss over all observed positions [px²]
};

/// Bundle adjustment of several views from an initial guess of two of them: Levenberg-Marquardt on the reprojection
/// errors, with the points eliminated (Schur complement). The loss is bounded, so that all gross errors cost the same.
/// Every track is in every estimate, whether or not the guess had it, so that costs are comparable.
class MultiView {
 public:
  MultiView(TrackViews views, const PinholeCamera& camera) : views_(std::move(views)), camera_(camera) {}

  const TrackViews& views() const { return views_; }

  /// Extends the guess to all views. None on failure.
  std::optional<ViewsEstimate> start(const InitialGuess& guess, double width) const;

  /// Refines the estimate with at most `iterations` iterations; stops when the cost has converged.
  void refine(ViewsEstimate& estimate, double width, int iterations) const;

  /// Uncertainty of the structure, by track: the standard deviation of the logarithm of the distance in units of the
  /// longest baseline. The noise is taken from the residuals but is at least half the sigma of an observation, because
  /// slow drift of a track does not show in residuals. Infinite without a baseline.
  std::vector<double> distance_sigmas(const ViewsEstimate& estimate) const;

  /// Mean reprojection error [px], by track.
  std::vector<double> errors(const ViewsEstimate& estimate) const;

 private:
  class Step;

  /// Squared errors of a track's positions [px²]; large ones for points behind the camera.
  std::vector<double> squared_errors(const ViewsEstimate& estimate, std::size_t track) const;
  void update_cost(ViewsEstimate& estimate) const;

  TrackViews views_;
  PinholeCamera camera_;
};

}  // namespace evbench
