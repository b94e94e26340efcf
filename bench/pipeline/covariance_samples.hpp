#pragma once

#include <limits>
#include <vector>

#include "core/data/relative_poses.hpp"
#include "core/plugin/backend.hpp"

namespace evbench {

/// Samples the covariances of a back-end, if it has any, for the consistency scores (ANEES). The time that this takes
/// counts as the harness', not as the back-end's.
class CovarianceSamples {
 public:
  /// Called after an update: samples the newest published pose, unless the last sample is less than 0.1 s older.
  void take(const StampedPose& newest, BackEnd& backend);

  /// Called after the end. Returns the sampled newest poses, relative to the first pose of the final estimate, which
  /// anchors the back-end's world frame; and relative poses of the final estimate over about 0.1 s and 1 s, at most 50
  /// of each, evenly distributed.
  std::vector<RelativePose> finish(BackEnd& backend) const;

 private:
  struct Newest {
    StampedPose pose;
    Matrix6 covariance;
  };
  std::vector<Newest> newest_;
  double sampled_ = -std::numeric_limits<double>::infinity();  ///< [s] time of the last sample
};

}  // namespace evbench
