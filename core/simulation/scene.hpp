#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/plugin/options.hpp"
#include "core/simulation/motion.hpp"
#include "core/simulation/random.hpp"

namespace evbench {

struct SceneOptions {
  std::string kind = "plane";
  int points = 2000;
  double near = 1.0, far = 3.0;
  int boxes = 12;

  void declare(OptionSet& set);
};

/// The raw pixel at which a camera at T_world_camera sees a point; none behind the camera, less than `border` [px]
/// inside the image, or where the lens model folds back.
std::optional<Vector2> visible_pixel(const Camera& camera, const SE3& T_world_camera, const Vector3& point,
                                     double border);

/// The visible features of a scene: dots, placed in the camera's view during the motion.
/// - volume: dots anywhere in the box that the views between the depths near and far fill;
/// - plane: dots on the plane at right angles to the mean view direction, half way between near and far;
/// - boxes: dots on the faces of boxes in that volume;
/// - frustum: no fixed dots; each new feature is a point at a random pixel at a random depth between near and far.
class Scene {
 public:
  /// Throws InputError unless near < far.
  Scene(const SceneOptions& options, const Camera& camera, const Motion& motion, double duration, Random random);

  /// Is the point unoccluded by the scene for a camera at T_world_camera?
  using Visibility = std::function<bool(const SE3& T_world_camera, const Vector3& point)>;

  /// The given dots, world frame, on surfaces that hide what is behind them.
  Scene(std::vector<Vector3> points, const Camera& camera, Visibility unoccluded);

  /// visible_pixel() where nothing is in front of the point.
  std::optional<Vector2> pixel(const SE3& T_world_camera, const Vector3& point, double border) const;

  /// All dots, world frame; empty for frustum.
  const std::vector<Vector3>& points() const { return points_; }

  /// A point for a new track: the camera sees it at T, `border` [px] inside the image, and no other track observes it
  /// at time t; none if there is no such point. The caller then states with occupy() how long the track will observe
  /// it.
  struct Pick {
    Vector3 position;
    std::optional<std::size_t> point;  ///< index in points(); none for frustum
  };
  std::optional<Pick> pick(double t, const SE3& T_world_camera, double border, Random& random) const;
  void occupy(const Pick& pick, double until);

 private:
  SceneOptions options_;
  Camera camera_;
  std::vector<Vector3> points_;
  Visibility unoccluded_;  ///< none: no dot hides another
  std::vector<double> busy_until_;
};

}  // namespace evbench
