#pragma once

#include <cstdint>
#include <vector>

#include "core/simulation/random.hpp"
#include "core/smoother/smoother.hpp"
#include "core/support/index.hpp"

namespace evbench::smoother::testing {

struct DrawnOptions {
  enum class Gauge {
    landmark_priors,  ///< every landmark has a prior
    scale_anchor,     ///< none has, the scale anchor fixes the scale
  };
  enum class Observed {
    at_states,       ///< at the times of control states
    between_states,  ///< at times between them, from the interpolated pose, as in the factors
  };
  Gauge gauge = Gauge::landmark_priors;
  Observed observed = Observed::between_states;
  MotionPrior motion_prior = {};
  double qc = 0.01;          ///< [rad²/s³, m²/s³]
  double pixel_sigma = 0.1;  ///< stated [px]
  double noise_scale = 1.0;  ///< true pixel noise over the stated one
  double edge = 1.0;         ///< a landmark's noise along a direction of its own over that across it
};

/// A problem whose unknowns and measurements are drawn from exactly the densities of the factors, so that the errors of
/// an estimate must match its covariance. 60 control states in 3 s, 24 live landmarks, each observed once an interval
/// for at most a second. The noise is small: otherwise the depths of landmarks with little parallax would be far from
/// Gaussian, which no covariance describes.
class DrawnProblem {
 public:
  static constexpr int kStates = 60;
  static constexpr int kSteps = 4;  ///< steps of the drawn trajectory in an interval
  static constexpr double kInterval = 0.05, kStep = kInterval / kSteps;

  DrawnProblem(const DrawnOptions& options, std::uint64_t seed);

  /// The trajectory at i kStep, i ≤ (kStates − 1) kSteps.
  const ControlState& truth(int i) const { return truth_[index(i)]; }

  /// Feeds the problem to an engine, one update a control state. A landmark enters with its fifth observation.
  Smoother solve_incrementally(const SmootherOptions& options = {}) const;

 private:
  struct Landmark {
    Vector3 position, guess;
    LandmarkPrior prior;
    int first = 0;  ///< interval in which it is seen first
    std::vector<Observation> observations;
  };

  void draw_trajectory();
  void draw_landmark(int first, int last);
  void draw_anchor();
  Vector3 normal3(double sigma);
  Vector6 normal6(double sigma);

  DrawnOptions options_;
  Random random_;
  Vector6 qc_;
  PosePrior pose_prior_;
  VelocityPrior velocity_prior_;
  std::vector<ControlState> truth_;
  std::vector<Landmark> landmarks_;
  std::vector<int> anchors_;
};

}  // namespace evbench::smoother::testing
