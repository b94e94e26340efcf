#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/smoother/factor_graph.hpp"

namespace evbench::smoother {

struct SmootherOptions {
  /// Threshold of relinearisation [rad]. When a variable's increment changes a viewing direction by more than this, its
  /// linearisation point moves to the estimate, and the stages from there on are redone. Rotations count as they are,
  /// translations divided by the nearest landmark's distance, velocities by how far they move the trajectory between
  /// two states. Landmarks count by the geometric mean of their change relative to their distance and its part across
  /// the viewing direction.
  double relinearise = 0.015;
  /// Maximum number of stages that are redone for relinearisation alone. Older variables keep their linearisation
  /// points until observations cause their stages to be redone, or until optimise(). Bounds the time of an update.
  int reach = 128;
  /// A landmark that is re-acquired within this many states after its elimination has the stages since then redone.
  /// Later it returns to the root without that (returns.hpp). With a lag the stages are always redone.
  int redone_for_return = 100;
  /// `relinearise` for variables in stages that are redone anyway: only their intervals have to be linearised again.
  double relinearise_redone = 0.0015;
  /// Back-substitution stops where the separator of a stage changes by less than this over √n with n landmarks in the
  /// root [rad, as above]: n landmarks together determine a variable √n times better than one. With Singer's prior a
  /// quarter of it.
  double solve_tolerance = 3.8e-3;
  /// An update that changes a variable by more than this [rad] must not raise the cost of the affected intervals.
  double check_step = 0.02;
  /// A landmark is eliminated once it has not been observed for this many states [≥ 1].
  int grace = 1;
  /// Number of newest intervals whose linearisation is kept.
  int kept_intervals = 64;
  /// Lag of a fixed-lag smoother [s]: states that are older than the newest by more than this are marginalised; 0: full
  /// history. Their information about the other variables stays as a prior, their estimates stay unchanged, and changes
  /// of their factors are refused.
  double lag = 0.0;
};

/// ∂(image)/∂(increment of a state): 12 or 18 columns.
using ImageJacobian = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, 18>;

/// What an update did.
struct UpdateSummary {
  int first_stage = 0;      ///< oldest stage that was redone
  int stages = 0;           ///< redone stages, with repetitions
  int solved_back = 0;      ///< stages whose variables were solved for
  int linearised = 0;       ///< observations that were linearised
  double damping = 0.0;     ///< λ of the accepted step; 0: undamped
  bool rejected = false;    ///< no step lowered the cost: the estimate is unchanged
  bool unsolvable = false;  ///< rejected because the system could not be solved at all
  /// Not empty if a variable was not determined by its factors (it is then regularised by a weak damping), or if the
  /// system was unsolvable.
  std::string reason;
};

/// What an optimisation did.
struct OptimiseSummary {
  double initial_cost = 0.0, final_cost = 0.0;
  int iterations = 0;
  bool converged = false;
  std::string reason;
};

/// Incremental smoothing: maximum-a-posteriori inference over a chain of control states and landmarks that are in view
/// for a while, by an incremental block Cholesky factorisation in time order (docs/algorithms/smoother.md). The cost of
/// an update depends on the live landmarks and on how far back it reaches, not on the length of the history.
///
///   Smoother smoother(camera, qc, RobustLoss());
///   smoother.add_state({0.0, SE3(), Vector6::Zero()});
///   smoother.add_pose_prior({0, SE3(), Vector6::Constant(1e-4)});
///   for each key time t:
///     smoother.add_state_at(t);                    // continues the newest one as the motion prior expects
///     smoother.add_observation(landmark, {time, pixel, 1.0 / sigma});  // any time until t
///     smoother.update();
///     smoother.graph().states.back();              // the newest estimate
///
/// Times in seconds, increments of poses on the right (T ← T Exp(δ)), T = T_world_camera, pixels undistorted. Nothing
/// throws; what cannot be done returns false or is reported in the summary of the update.
class Smoother {
 public:
  /// `qc`: power spectral density of the motion prior, diagonal, body frame (MotionPrior).
  Smoother(const PinholeCamera& camera, const Vector6& qc, const RobustLoss& loss, const SmootherOptions& options = {},
           const MotionPrior& motion_prior = {});

  /// Starts from a graph with estimates, solved or not. The first update reaches back to its beginning.
  Smoother(FactorGraph graph, const SmootherOptions& options = {});

  Smoother(const Smoother& other);
  Smoother(Smoother&& other) noexcept;
  Smoother& operator=(const Smoother& other);
  Smoother& operator=(Smoother&& other) noexcept;
  ~Smoother();

  /// The problem with the present estimate of every variable, including observations added since the last update. The
  /// estimates of variables n states ago may be up to n / 64 updates old; see update_everything().
  const FactorGraph& graph() const;

  /// The oldest state that is still being estimated.
  int first_state() const;

  /// Has a landmark been marginalised? It then takes no more observations.
  bool is_marginalised(int landmark) const;

  /// A landmark's mean reprojection error over all its observations, including marginalised ones [px]: in the newest
  /// interval at the estimate, in older ones at the linearisation points. Infinite behind the camera. Constant time.
  double reprojection_mean(int landmark);

  /// Adds a state later than the newest one, with the motion prior between them.
  void add_state(const ControlState& guess);
  /// The same at t, extrapolated from the newest state by the motion prior; the first one at the origin, at rest.
  void add_state_at(double t);
  void add_pose_prior(const PosePrior& prior);
  void add_velocity_prior(const VelocityPrior& prior);
  void anchor_scale(const Vector3& origin, std::vector<int> landmarks);

  /// Adds a landmark. It becomes part of the solution with its first observation.
  int add_landmark(const Vector3& guess, const LandmarkPrior& prior = {});
  /// Removes a landmark's prior. Does nothing once the landmark is partly marginalised.
  void remove_prior(int landmark);

  /// Adds an observation at any time within the states' span, late or not. Returns false and adds nothing outside that
  /// span, for a value that is not finite, for a removed landmark, and for what a lag has marginalised.
  bool add_observation(int landmark, const Observation& observation);

  /// Prepares add_observation_and_update() for the interval that ends in the newest state. Queries made afterwards,
  /// including covariances, do not change the effect of observations. False if add_observation_and_update() will only
  /// add observations.
  bool open_newest_interval();

  /// Like add_observation(), but the newest two states are updated at once: exactly for the present linearisation;
  /// landmarks and older states follow with the next update. It applies to observations in the newest interval, after
  /// an update() of everything before the newest state, of landmarks that were alive in it. For others it returns false
  /// and only adds the observation. Takes microseconds.
  bool add_observation_and_update(int landmark, const Observation& observation);

  /// Removes the newest state, with the observations in its interval and the priors on it. With a lag, first_state()
  /// cannot be removed.
  void remove_newest_state();

  /// Sets the power spectral density of the motion prior in interval k, with its expansion (factor_graph.hpp), and in
  /// future intervals.
  void set_qc(int k, const Vector6& qc, double expansion = 0.0);
  void set_next_qc(const Vector6& qc);

  /// Sets the robust loss. Intervals that are not linearised again keep the loss of their linearisation.
  void set_loss(const RobustLoss& loss);

  /// Removes a landmark with all its observations.
  void remove_landmark(int landmark);

  /// Removes a landmark's observations from a time on. Marginalised ones stay.
  void remove_observations(int landmark, double from);

  /// Scales the sigmas of a landmark's observations, including future ones. Marginalised ones stay unchanged.
  void scale_sigmas(int landmark, double scale);

  /// Sets the estimate from which the next update starts. Returns false and changes nothing for a variable that is
  /// marginalised or tied to marginalised ones, and for a landmark that returned without its stages being redone.
  bool set_state(int i, const ControlState& estimate);
  bool set_landmark(int landmark, const Vector3& position);

  /// One Gauss-Newton step over everything that the changes since the last update affect, damped if it would raise the
  /// cost.
  UpdateSummary update();

  /// The same, back to the first state: graph() is then up to date everywhere.
  UpdateSummary update_everything();

  /// Optimises everything; only with full history. Gauss-Newton steps, shortened and damped as needed, until a full
  /// step lowers the cost by less than the tolerance.
  OptimiseSummary optimise(int max_iterations, double relative_tolerance);

  // Marginal covariances at the linearisation points (increments on the right), in the gauge of the priors; none if the
  // system is singular. The time is proportional to the number of states since the variable was alive.

  /// Joint covariance of states k and k + 1, 24 × 24 (36 × 36 with Singer's prior).
  std::optional<PairMatrix> neighbours(int k);
  /// The same for k = first − 1, first, ... up to the newest state but one, in the time of a few stages each. Empty if
  /// the system is singular.
  std::vector<PairMatrix> chain_covariances(int first);
  /// Joint covariance of the poses of states i < j.
  std::optional<Matrix12> poses(int i, int j);
  /// Covariance of pose and velocity at any time within the states' span.
  std::optional<Matrix12> covariance(double t);
  /// Covariance of the newest state, from the root alone.
  std::optional<Matrix12> newest_covariance();
  std::optional<Matrix3> landmark_covariance(int landmark);
  /// Covariance of J_state δ_newest + J_landmark δ_landmark, e.g. of a landmark's predicted image. A landmark that has
  /// left the root counts as independent of the newest state.
  std::optional<Matrix2> predicted_covariance(int landmark, const ImageJacobian& J_state, const Matrix23& J_landmark);

 private:
  std::unique_ptr<class Engine> engine_;
};

}  // namespace evbench::smoother
