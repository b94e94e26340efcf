#pragma once

#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/pixel_noise.hpp"
#include "core/motion/gp_interval.hpp"

namespace evbench {

/// A continuous-time structure-from-motion problem as exchanged between engines: control states, landmarks,
/// observations at their own times, a WNOA prior, Gaussian priors. Indices are positions in `states` and `landmarks`.
/// Seconds, pixels, world frame; sigmas are standard deviations; 6-vectors are (rotation, translation).
struct Problem {
  struct Observation {
    double t = 0.0;
    int landmark = 0;
    Vector2 pixel = Vector2::Zero();  ///< undistorted
    PixelNoise noise = 1.0;
  };
  struct PosePrior {
    int state = 0;
    SE3 T;  ///< residual Log(T⁻¹ T_state) / sigma
    Vector6 sigma = Vector6::Ones();
  };
  struct VelocityPrior {
    int state = 0;
    Vector6 velocity = Vector6::Zero();
    Vector6 sigma = Vector6::Ones();
  };
  struct LandmarkPrior {
    int landmark = 0;
    Vector3 position = Vector3::Zero();
    double sigma = 1.0;
  };

  PinholeCamera camera;
  Vector6 qc = Vector6::Ones();      ///< diagonal of the WNOA prior's power spectral density, body frame
  std::vector<ControlState> states;  ///< initial guess, in time order
  std::vector<Vector3> landmarks;    ///< initial guess
  std::vector<Observation> observations;
  std::vector<PosePrior> pose_priors;
  std::vector<VelocityPrior> velocity_priors;
  std::vector<LandmarkPrior> landmark_priors;
};

/// Reads a problem (gzip or not). Observations and priors keep the order of the file. One record per line, in any
/// order:
///
///   CAM fx fy cx cy                                  pinhole, once
///   QC q1..q6                                        once, > 0
///   STATE i t qx qy qz qw px py pz wx wy wz vx vy vz T_world_camera and body velocity; i = 0, 1, 2, ... in time order
///   LM j x y z                                       j = 0, 1, 2, ...
///   OBS t j u v sigma                                or `OBS t j u v xx xy yy` with the covariance [px²]
///   PRIORPOSE i qx qy qz qw px py pz s1..s6
///   PRIORVEL i wx wy wz vx vy vz s1..s6
///   LMPRIOR j x y z sigma
///
/// Throws InputError with file and line for an unknown record, a wrong number of columns, a value that is not finite, a
/// repeated or missing index, a reference to a missing index, times that do not increase, a sigma ≤ 0, a quaternion
/// that is not a rotation, and a file without CAM, QC or STATE.
Problem read_problem(const std::string& path);

/// The records in the order of the table above, with the shortest digits that read back as the same numbers.
std::string format_problem(const Problem& problem);

/// Prepares a problem for solving: drops observations outside [first state, last state], then all observations and
/// priors of landmarks with fewer than two observations left; sorts observations by time, then by landmark. Indices are
/// unchanged: a landmark without observations keeps its index.
Problem prepare(Problem problem);

}  // namespace evbench
