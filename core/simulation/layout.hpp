#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/motion/pose_trajectory.hpp"
#include "core/simulation/random.hpp"

namespace evbench {

/// Where objects must be so that a camera sees them on its path.
struct SceneLayout {
  SE3 frame;  ///< T_world_scene: mean position and mean orientation of the camera, z ahead
  PoseTrajectory path;
  std::vector<Vector3> rays;  ///< of the image's corners, middles of its sides, and its middle; z = 1

  SceneLayout(const Camera& camera, PoseTrajectory path);

  /// The box, in the scene's frame, that holds all views between depths near and far.
  Eigen::AlignedBox3d viewed_volume(double near, double far) const;

  /// The rectangle, in the scene's frame, that the views cover on the plane z = depth. Rays that run along the plane or
  /// away from it are cut at five times the depth, which keeps the rectangle where the camera mostly points.
  Eigen::AlignedBox3d viewed_rectangle(double depth) const;
};

Vector3 point_in(const Eigen::AlignedBox3d& box, Random& random);

/// A box turned about the vertical axis (y) of the scene's frame.
struct UprightBox {
  Vector3 centre, half;  ///< half: of the edges
  Eigen::Quaterniond turn;

  /// Its centre in the volume, with edges of 5 to 20 % of the volume's mean edge.
  UprightBox(const Eigen::AlignedBox3d& volume, Random& random);

  Vector3 point_on_face(Random& random) const;
};

}  // namespace evbench
