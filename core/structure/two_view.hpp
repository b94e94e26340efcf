#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/plugin/options.hpp"

namespace evbench {

struct TwoViewOptions {
  double threshold_px = 1.5;      ///< RANSAC: distance of an inlier from its model
  double confidence = 0.9999;     ///< RANSAC
  int max_iterations = 1000;      ///< RANSAC, of five points
  int min_inliers = 12;           ///< matches that a candidate must explain
  double min_inlier_share = 0.5;  ///< the same as a share of all matches
  double min_parallax_deg = 4.0;  ///< median angle between the rays to a point; 0: none, and a rotation may explain it
  double ambiguity = 0.75;        ///< a candidate stays when it explains this share of what the best one explains

  void declare(OptionSet& set);
};

/// One explanation of the matches: a relative pose with the points that it implies.
struct TwoViewCandidate {
  enum class Model { five_point, homography };
  Model model = Model::five_point;
  SE3 T_first_second;                ///< pose of the second camera in the first one's frame; translation of length one
  std::vector<bool> inlier;          ///< by match: in front of both cameras, reprojection error below the threshold
  std::vector<Vector3> points;       ///< by match, in the first camera's frame; zero for an outlier
  int inliers = 0;                   ///< count
  double median_parallax_deg = 0.0;  ///< of the inliers
  double rms_px = 0.0;               ///< root mean square distance of inliers from their reprojection, per image
};

struct TwoViewResult {
  std::vector<TwoViewCandidate> candidates;  ///< best first; distinct
  std::string reason;                        ///< why there is none
};

/// Relative pose from matched pixels (first[i] and second[i] show the same point).
///
/// Two models compete, for neither does for all scenes: five-point with RANSAC (Nistér 2004), which is ill-conditioned
/// for planar scenes, and the homography, which holds for planes only and has two solutions there. All that explain
/// the data about as well are returned, each refined by least squares on the epipolar distance; more views than two
/// decide between them. None is returned when a rotation alone explains the matches (pure rotation, or no parallax
/// yet), unless no parallax is asked for: then others decide what the candidates are worth. Deterministic: the RANSAC
/// of OpenCV draws from a generator with a fixed seed.
TwoViewResult relative_pose(std::span<const Vector2> first, std::span<const Vector2> second,
                            const PinholeCamera& camera, const TwoViewOptions& options = {});

}  // namespace evbench
