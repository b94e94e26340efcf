#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/plugin/options.hpp"

namespace evbench {

struct TwoViewOptions {
  double threshold_px = 1.5;      ///< RANSAC: maximum distance of an inlier from its model
  double confidence = 0.9999;     ///< RANSAC
  int max_iterations = 1000;      ///< RANSAC, samples of five points
  int min_inliers = 12;           ///< minimum number of inliers
  double min_inlier_share = 0.5;  ///< the same as a fraction of all matches
  double min_parallax_deg = 4.0;  ///< minimum median parallax; 0: none, and a pure rotation is accepted
  double ambiguity = 0.75;        ///< a candidate is kept if it has this fraction of the best one's inliers

  void declare(OptionSet& set);
};

/// A candidate for the relative pose, with the triangulated points.
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
  std::string reason;                        ///< why there is no candidate
};

/// Relative pose from matched pixels (first[i] and second[i] show the same point).
///
/// Two models compete, because neither suits all scenes: five-point with RANSAC (Nistér 2004), which is ill-conditioned
/// for planar scenes, and the homography, which is valid for planes only and has two solutions there. All candidates
/// that fit the data about equally well are returned, each refined by least squares on the epipolar distance; further
/// views decide between them. None is returned if a rotation alone explains the matches (pure rotation, or no parallax
/// yet), unless min_parallax_deg is 0: then the caller has to check the candidates. Deterministic: OpenCV's RANSAC
/// draws from a generator with a fixed seed.
TwoViewResult relative_pose(std::span<const Vector2> first, std::span<const Vector2> second,
                            const PinholeCamera& camera, const TwoViewOptions& options = {});

}  // namespace evbench
