#pragma once

#include <span>
#include <string>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/plugin/options.hpp"

namespace evbench {

struct TriangulationOptions {
  double min_parallax_deg = 1.0;  ///< minimum of the largest angle between two rays
  double max_rms_px = 3.0;        ///< maximum root mean square of the reprojection error's norm
  int iterations = 10;            ///< maximum of Levenberg-Marquardt

  void declare(OptionSet& set);
};

struct Triangulation {
  enum class State {
    ok,
    too_few_views,  ///< fewer than two
    not_finite,     ///< input with NaN or infinity, or no solution
    low_parallax,   ///< the rays are parallel within min_parallax_deg: a point at infinity
    behind_camera,  ///< of at least one view
    large_error,    ///< rms_px above max_rms_px
  };
  State state = State::too_few_views;
  Vector3 point = Vector3::Zero();  ///< world frame; valid for ok and large_error only
  double parallax_deg = 0.0;        ///< largest angle between two rays (to within a factor two from below, exact for 2)
  double rms_px = 0.0;              ///< of the reprojection error's norm
  double min_depth = 0.0;           ///< smallest z in a camera

  bool ok() const { return state == State::ok; }
};

std::string to_string(Triangulation::State state);  ///< a phrase: "low parallax"

/// The point seen at pixels[i] from the camera at T_world_camera[i]: the point nearest to all rays, then
/// Levenberg-Marquardt on the reprojection error. The cost grows linearly with the number of views.
Triangulation triangulate(std::span<const SE3> T_world_camera, std::span<const Vector2> pixels,
                          const PinholeCamera& camera, const TriangulationOptions& options = {});

}  // namespace evbench
