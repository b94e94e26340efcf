#pragma once

#include <map>
#include <optional>
#include <span>

#include "core/geometry/camera.hpp"
#include "core/plugin/exchange.hpp"

namespace evbench::haste {

/// What the back-end knows, carried forward to the present: its newest state goes on with constant velocity, and is
/// corrected by what the trackers see since.
class Guidance {
 public:
  /// `degraded`: also while the back-end is.
  Guidance(const Camera& camera, bool degraded) : camera_(camera), degraded_(degraded) {}

  void receive(const Feedback& feedback);

  /// Whether the motion is known well enough to predict anything.
  bool available() const { return newest_.has_value(); }
  /// Whether observations have determined it, not a motion model alone: what contradicts it is wrong.
  bool reliable() const { return reliable_; }

  /// The number of the world that all of it is in.
  std::size_t world() const { return world_; }

  /// A landmark, where a tracker has it.
  struct Sighting {
    TrackId track;
    double t;       ///< [s]
    Vector2 pixel;  ///< [px], raw
  };
  /// Turns and shifts the predicted motion so that it fits what is seen now, by robust least squares; as it is with too
  /// few landmarks.
  void correct(std::span<const Sighting> sightings);

  /// T_world_camera at t [s]. Precondition: available().
  SE3 pose(double t) const { return extrapolate(*newest_, t - newest_->t).T * correction_; }

  /// Of a landmark that is expected in view, world frame.
  std::optional<Vector3> position(TrackId track) const;

  /// Where a landmark's image is expected at t.
  struct Prediction {
    Vector2 pixel;       ///< [px], raw
    Matrix2 covariance;  ///< [px²]
  };
  /// None: the back-end doesn't expect it in view, or it is behind the camera.
  std::optional<Prediction> predict(TrackId track, double t) const;

  /// All that may be in view.
  const std::map<TrackId, ExpectedFeature>& expected() const { return expected_; }

 private:
  const Camera& camera_;
  bool degraded_, reliable_ = false;
  std::size_t world_ = 0;
  std::optional<ControlState> newest_;
  SE3 correction_;
  std::map<TrackId, ExpectedFeature> expected_;
};

/// How the surroundings of a point look from another pose: the image about it turns by `angle` [rad, from x to y] and
/// grows by `scale`, for a surface that faces the camera.
struct AppearanceChange {
  double angle = 0.0, scale = 1.0;
};
AppearanceChange appearance_change(const SE3& T_world_before, const SE3& T_world_now, const Vector3& point);

}  // namespace evbench::haste
