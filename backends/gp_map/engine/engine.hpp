#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "backends/gp_map/engine/factorisation.hpp"
#include "backends/gp_map/engine/live_factor.hpp"

namespace evbench::gp_map {

struct EngineOptions {
  /// A variable's linearisation point moves to the estimate, and the stages from there on are redone, when its
  /// increment changes a viewing direction by more than this [rad]: rotations as they are, translations by the
  /// nearest landmark's distance, velocities by what they move the trajectory between two states. Landmarks by the
  /// geometric mean of their change relative to their distance and its part across the viewing direction.
  double relinearise = 0.015;
  /// ... unless more than this many stages would have to be redone: what is older stays linear until observations make
  /// its stages be redone, or until optimise(). Bounds the time of an update.
  int reach = 128;
  /// A landmark seen again within this many states after it was eliminated has them redone; later it comes back
  /// into the root without that (returns.hpp). With a lag they are always redone.
  int redone_for_return = 100;
  /// The same for variables in stages that are redone anyway: only their intervals have to be linearised anew.
  double relinearise_redone = 0.0015;
  /// Back-substitution ends where the change of what a stage is solved from is below this over √n with n landmarks in
  /// the root [rad, as above]: what n landmarks determine together is known √n times better than by one.
  double solve_tolerance = 3.8e-3;
  /// An update that changes a variable by more than this [rad] must not raise the cost of the intervals concerned.
  double check_step = 0.02;
  /// States for which a landmark may go unobserved before it is eliminated [≥ 1].
  int grace = 1;
  /// Of the newest intervals, how many keep their linearisation.
  int kept_intervals = 64;
  /// States older than this before the newest are marginalised [s]; 0: full history. What they say about the others
  /// stays as a prior, their estimates stay as they are, and what would change their factors is refused.
  double lag = 0.0;
};

/// What an update did.
struct UpdateSummary {
  int first_stage = 0;      ///< oldest stage that was redone
  int stages = 0;           ///< redone, repetitions counted
  int solved_back = 0;      ///< stages whose variables were solved for
  int linearised = 0;       ///< observations
  double damping = 0.0;     ///< λ of the accepted step; 0: undamped
  bool rejected = false;    ///< no step lowered the cost: the estimate is that of before
  bool unsolvable = false;  ///< rejected because the system could not be solved at all
  /// Empty unless something was not determined by its factors (it is held by a weak damping then) or unsolvable.
  std::string reason;
};

/// Incremental maximum-a-posteriori inference over a chain of control states with landmarks that live for a while:
/// an incremental block Cholesky factorisation in the order of time (factorisation.hpp; docs/algorithms/smoother.md has the design).
/// The cost of an update depends on the landmarks alive and on how far back it reaches, not on the length of history.
///
///   engine.add_state(x0); engine.add_pose_prior(...); engine.update();
///   loop: engine.add_state(...); engine.add_observation(...); engine.update(); engine.graph().states.back()
class Engine {
 public:
  Engine(const PinholeCamera& camera, const Vector6& qc, const RobustLoss& loss, const EngineOptions& options = {});

  /// From a graph with estimates, solved or not; the first update reaches back to its beginning.
  Engine(FactorGraph graph, const EngineOptions& options);

  /// The problem with the present estimate of every variable. Observations added since the last update are in it.
  /// States and landmarks n states ago have heard of what was added up to n / 64 updates ago: see settle().
  const FactorGraph& graph() const { return graph_; }

  /// The oldest state that is still being estimated.
  int first_state() const { return std::max(0, factorisation_.base()); }

  /// Whether a landmark has been marginalised: it takes no more observations.
  bool forgotten(int landmark) const { return factorisation_.is_forgotten(landmark); }

  /// A landmark's mean reprojection error over all its observations, those that have been marginalised included [px]:
  /// in the newest interval at the estimate, before at the linearisation points. Infinite behind the camera. Constant
  /// time.
  double reprojection_mean(int landmark);

  /// A state later than the newest one, with the motion prior between them.
  void add_state(const ControlState& guess);
  void add_pose_prior(const PosePrior& prior);
  void add_velocity_prior(const VelocityPrior& prior);
  void anchor_scale(const Vector3& origin, std::vector<int> landmarks);

  /// Becomes part of the solution with its first observation.
  int add_landmark(const Vector3& guess, const LandmarkPrior& prior = {});
  /// From now on the landmark has no prior. Refused once it has been marginalised in part.
  void drop_prior(int landmark);

  /// At any time within the states' span, late or not. False, and nothing added, outside it, for a value that is not
  /// finite, a landmark that was removed, and with a lag for what has been marginalised.
  bool add_observation(int landmark, const Observation& observation);

  /// Gets ready for observe() in the interval that ends in the newest state. What is asked for from then on,
  /// covariances as well, does not change what observations do. False where observe() will only add them.
  bool open_newest();

  /// add_observation that at once brings the newest two states to what their factors so far ask for: exact for the
  /// present linearisation (landmarks and older states follow with the next update). For observations in the newest
  /// interval, after an update() of everything before the newest state, of landmarks that were alive in it; false, and
  /// the observation only added, for others. Microseconds.
  bool observe(int landmark, const Observation& observation);

  /// Takes the newest state back, with the observations in its interval and the priors on it. With a lag not
  /// first_state().
  void remove_newest_state();

  /// Power spectral density of the motion prior over interval k, with its expansion (factor_graph.hpp), and over the
  /// intervals to come.
  void set_qc(int k, const Vector6& qc, double expansion = 0.0);
  void set_next_qc(const Vector6& qc) { graph_.qc = qc; }

  /// The robust loss from now on; intervals that are not linearised anew keep the one that they were linearised with.
  void set_loss(const RobustLoss& loss) { graph_.loss = loss; }

  /// Removes a landmark with all its observations.
  void remove_landmark(int landmark);

  /// Removes a landmark's observations from a time on; what has been marginalised stays.
  void remove_observations(int landmark, double from);

  /// Makes the sigmas of a landmark's observations, those to come included, so many times those that they are given;
  /// what has been marginalised stays as it was.
  void scale_sigmas(int landmark, double scale);

  /// Makes this the estimate, from which the next update starts. False, and nothing moved, for what has been
  /// marginalised, or is tied to what has been, and for a landmark that came back without its stages being redone.
  bool place_state(int i, const ControlState& estimate);
  bool place_landmark(int landmark, const Vector3& position);

  /// One Gauss-Newton step over what the changes since the last update concern, damped if it would raise the cost.
  UpdateSummary update();

  /// The same, back to the beginning: graph() is then up to date everywhere.
  UpdateSummary settle();

  /// Of a full history only. Gauss-Newton steps over everything, shortened and damped where needed, until a full step
  /// lowers the cost by less than the tolerance.
  struct OptimiseSummary {
    double initial_cost = 0.0, final_cost = 0.0;
    int iterations = 0;
    bool converged = false;
    std::string reason;
  };
  OptimiseSummary optimise(int max_iterations, double relative_tolerance);

  // Marginal covariances at the linearisation points (increments on the right), in the gauge of the priors; none when
  // the system is singular. Time: proportional to how many states ago the variable was alive.

  /// Of states k and k + 1 jointly, 24 × 24.
  std::optional<Matrix24> neighbours(int k);
  /// The same for k = first − 1, first, ... up to the newest state but one, at the price of a few stages for each; none
  /// of them when the system is singular.
  std::vector<Matrix24> chain_covariances(int first);
  /// Of the poses of states i < j jointly.
  std::optional<Matrix12> poses(int i, int j);
  /// Of pose and velocity at any time within the states' span.
  std::optional<Matrix12> covariance(double t);
  /// Of the newest state, in no time.
  std::optional<Matrix12> newest_covariance();
  std::optional<Matrix3> landmark_covariance(int landmark);
  /// Of J_state δ_newest + J_landmark δ_landmark, e.g. of where a landmark's image is predicted. A landmark that has
  /// left the root counts as independent of the newest state.
  std::optional<Matrix2> predicted_covariance(int landmark, const Eigen::Matrix<double, 2, 12>& J_state,
                                              const Matrix23& J_landmark);

 private:
  /// A variable's increment before a solve, to undo it.
  struct Change {
    Variable variable;
    Vector12 before;  ///< a landmark's: the first 3
    double size;      ///< [rad]
  };

  /// Stage `stage` and those after it are to be redone.
  void invalidate(int stage) { restart_ = std::min(restart_, std::max(stage, factorisation_.base() + 1)); }
  void touch(int stage) {
    live_.drop();
    invalidate(stage);
  }
  void touch_landmarks(std::span<const int> landmarks);
  void touch_observations(int landmark);
  UpdateSummary update_back(int depth);
  bool insert(int landmark, const Observation& observation);
  void forget_old();
  double size_of_state(int i, const Vector12& delta) const;
  double size_of_landmark(int j, const Vector3& delta) const;
  int first_stage(const Variable& variable);
  void choose_points();
  void move(const Variable& variable);
  bool solve(double damping, UpdateSummary& summary);
  bool factorise_undamped();
  void solve_back(UpdateSummary& summary);
  void clear_returns(int k);
  double separator_change(int k) const;
  void set_state(int i, const double* delta);
  void set_landmark(int j, const double* delta, int slot);
  void refine_landmarks();
  double concerned_cost(const std::vector<int>& intervals) const;
  bool raises_cost();
  void swap_changes();
  void halve_changes();

  FactorGraph graph_;
  EngineOptions options_;
  LinearisationPoints points_;
  Factorisation factorisation_;
  LiveFactor live_;
  std::optional<GpInterval> live_interval_;  ///< at the linearisation points
  GpInterval::Derivatives live_derivatives_;
  bool damped_ = false;               ///< the factorisation at hand is
  bool newest_errors_taken_ = false;  ///< since the last update
  int restart_ = 0;                   ///< the oldest stage that has changed
  int updates_ = 0;
  int depth_ = 0;                     ///< how many stages back those are solved that were not redone
  double waiting_ = 0.0;              ///< change of the separator at that depth since those beyond it were solved
  Buffer delta_;                      ///< increments in the root's layout, while solving back
  std::vector<double> slot_change_;   ///< of the landmark in each slot, in the solve at hand
  double state_change_ = 0.0;         ///< of the newest state solved for
  std::vector<Change> changes_;       ///< of the last solve
  std::vector<Variable> candidates_;  ///< whose increments have grown beyond the threshold
  std::vector<Variable> refined_;     ///< landmarks whose estimate is not the linear solution
  std::vector<int> concerned_;        ///< intervals
};

}  // namespace evbench::gp_map
