#pragma once

#include <map>
#include <optional>
#include <span>

#include "core/geometry/camera.hpp"
#include "core/plugin/exchange.hpp"

namespace evbench::haste {

/// Predicts where landmarks are in the image now, from the back-end's feedback: its newest state is extrapolated with
/// constant velocity and corrected by the trackers' current positions.
class Guidance {
 public:
  /// `degraded`: also predicts while the back-end is degraded.
  Guidance(const Camera& camera, bool degraded) : camera_(camera), degraded_(degraded) {}

  void receive(const Feedback& feedback);

  /// Whether the motion is known well enough to predict.
  bool available() const { return newest_.has_value(); }
  /// Whether observations determine the motion, and not a motion model alone: a track that contradicts it is wrong.
  bool reliable() const { return reliable_; }

  /// The number of the world (map) that all positions are given in.
  std::size_t world() const { return world_; }

  /// A landmark at its tracker's position.
  struct Sighting {
    TrackId track;
    double t;       ///< [s]
    Vector2 pixel;  ///< [px], raw
  };
  /// Fits the predicted pose to the trackers' current positions by robust least squares. With too few landmarks the
  /// prediction stays as it is.
  void correct(std::span<const Sighting> sightings);

  /// T_world_camera at t [s]. Precondition: available().
  SE3 pose(double t) const { return extrapolate(*newest_, t - newest_->t).T * correction_; }

  /// The position of a landmark that is expected in view, world frame.
  std::optional<Vector3> position(TrackId track) const;

  /// Where a landmark's image is expected at t.
  struct Prediction {
    Vector2 pixel;       ///< [px], raw
    Matrix2 covariance;  ///< [px²]
  };
  /// None where the back-end does not expect the landmark in view, or where it is behind the camera.
  std::optional<Prediction> predict(TrackId track, double t) const;

  /// All landmarks that may be in view.
  const std::map<TrackId, ExpectedFeature>& expected() const { return expected_; }

 private:
  const Camera& camera_;
  bool degraded_, reliable_ = false;
  std::size_t world_ = 0;
  std::optional<ControlState> newest_;
  SE3 correction_;
  std::map<TrackId, ExpectedFeature> expected_;
};

/// How the appearance of a point's surroundings changes from one pose to another: the image around the point turns by
/// `angle` [rad, from x to y] and grows by `scale`, for a surface that faces the camera.
struct AppearanceChange {
  double angle = 0.0, scale = 1.0;
};
AppearanceChange appearance_change(const SE3& T_world_before, const SE3& T_world_now, const Vector3& point);

}  // namespace evbench::haste
