#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/smoother/engine/factorisation.hpp"
#include "core/smoother/engine/live_factor.hpp"
#include "core/smoother/smoother.hpp"

namespace evbench::smoother {

/// What Smoother hides: its documentation is there.
class Engine {
 public:
  Engine(FactorGraph graph, const SmootherOptions& options);
  const FactorGraph& graph() const { return graph_; }
  int first_state() const { return std::max(0, factorisation_.base()); }
  bool is_marginalised(int landmark) const { return factorisation_.is_marginalised(landmark); }
  double reprojection_mean(int landmark);
  void add_state(const ControlState& guess);
  void add_state_at(double t);
  void add_pose_prior(const PosePrior& prior);
  void add_velocity_prior(const VelocityPrior& prior);
  void anchor_scale(const Vector3& origin, std::vector<int> landmarks);
  int add_landmark(const Vector3& guess, const LandmarkPrior& prior = {});
  void remove_prior(int landmark);
  bool add_observation(int landmark, const Observation& observation);
  bool open_newest_interval();
  bool add_observation_and_update(int landmark, const Observation& observation);
  void remove_newest_state();
  void set_qc(int k, const Vector6& qc, double expansion = 0.0);
  void set_next_qc(const Vector6& qc) { graph_.qc = qc; }
  void set_loss(const RobustLoss& loss) { graph_.loss = loss; }
  void remove_landmark(int landmark);
  void remove_observations(int landmark, double from);
  void scale_sigmas(int landmark, double scale);
  bool set_state(int i, const ControlState& estimate);
  bool set_landmark(int landmark, const Vector3& position);
  UpdateSummary update();
  UpdateSummary update_everything();
  OptimiseSummary optimise(int max_iterations, double relative_tolerance);
  std::optional<PairMatrix> neighbours(int k);
  std::vector<PairMatrix> chain_covariances(int first);
  std::optional<Matrix12> poses(int i, int j);
  std::optional<Matrix12> covariance(double t);
  std::optional<Matrix12> newest_covariance();
  std::optional<Matrix3> landmark_covariance(int landmark);
  std::optional<Matrix2> predicted_covariance(int landmark, const ImageJacobian& J_state, const Matrix23& J_landmark);

 private:
  /// A variable's increment before a solve, to undo it.
  struct Change {
    Variable variable;
    StateVector before;  ///< of a landmark: 3 elements
    double size;         ///< [rad]
  };

  /// Stage `stage` and those after it must be redone.
  void invalidate(int stage) { restart_ = std::min(restart_, std::max(stage, factorisation_.base() + 1)); }
  void mark_dirty(int stage) {
    live_.drop();
    invalidate(stage);
  }
  void mark_landmarks_dirty(std::span<const int> landmarks);
  void mark_observations_dirty(int landmark);
  UpdateSummary update_back(int depth);
  bool insert(int landmark, const Observation& observation);
  void marginalise_old();
  double size_of_state(int i, const StateVector& delta) const;
  double size_of_landmark(int j, const Vector3& delta) const;
  int first_stage(const Variable& variable);
  void choose_points();
  void move(const Variable& variable);
  bool solve(double damping, UpdateSummary& summary);
  bool factorise_undamped();
  void solve_back(UpdateSummary& summary);
  void clear_returns(int k);
  double separator_change(int k) const;
  void set_state_increment(int i, const double* delta);
  void set_landmark_increment(int j, const double* delta, int slot);
  void refine_landmarks();
  double concerned_cost(const std::vector<int>& intervals) const;
  bool raises_cost();
  void swap_changes();
  void halve_changes();

  FactorGraph graph_;
  SmootherOptions options_;
  LinearisationPoints points_;
  Factorisation factorisation_;
  LiveFactor live_;
  std::optional<GpInterval> live_interval_;  ///< at the linearisation points
  GpInterval::Derivatives live_derivatives_;
  bool damped_ = false;               ///< the present factorisation is damped
  bool newest_errors_taken_ = false;  ///< since the last update
  int restart_ = 0;                   ///< the oldest stage that has changed
  int updates_ = 0;
  int depth_ = 0;                     ///< how many stages that were not redone are solved back
  double waiting_ = 0.0;              ///< change of the separator at that depth since the stages beyond it were solved
  Buffer delta_;                      ///< increments in the root's layout, while solving back
  std::vector<double> slot_change_;   ///< of the landmark in each slot, in the present solve
  double state_change_ = 0.0;         ///< of the newest state solved for
  std::vector<Change> changes_;       ///< of the last solve
  std::vector<Variable> candidates_;  ///< variables whose increments exceed the threshold
  std::vector<Variable> refined_;     ///< landmarks whose estimate is not the linear solution
  std::vector<int> concerned_;        ///< intervals
};

}  // namespace evbench::smoother
