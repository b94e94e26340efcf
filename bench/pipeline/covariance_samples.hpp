#pragma once

#include <limits>
#include <vector>

#include "core/data/relative_poses.hpp"
#include "core/plugin/backend.hpp"

namespace evbench {

/// Asks a back-end how sure it is, now and then, where it says so at all. This is no part of its work: the time that it
/// takes is the harness'.
class CovarianceSamples {
 public:
  /// After an update: of the newest pose published, unless another one was asked for less than 0.1 s before.
  void take(const StampedPose& newest, BackEnd& backend);

  /// After the end: the newest poses that were taken, relative to the first pose of the final estimate, which holds the
  /// back-end's world; and relative poses of the final estimate over about 0.1 and 1 s, evenly from all of it, at most
  /// 50 of each.
  std::vector<RelativePose> finish(BackEnd& backend) const;

 private:
  struct Newest {
    StampedPose pose;
    Matrix6 covariance;
  };
  std::vector<Newest> newest_;
  double asked_ = -std::numeric_limits<double>::infinity();  ///< [s] time of the last pose asked for
};

}  // namespace evbench
