#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/smoother/engine/conditional.hpp"
#include "core/smoother/engine/linearisation_points.hpp"
#include "core/smoother/engine/returns.hpp"
#include "core/smoother/engine/root_factor.hpp"

namespace evbench::smoother {

/// A state or a landmark.
struct Variable {
  enum class Kind { state, landmark };
  Kind kind = Kind::state;
  int index = 0;
  std::string name() const;
  bool operator==(const Variable&) const = default;
};

/// Damping of regularised variables. It stays when observations determine them later: at 1e-6 a landmark known to 20 m
/// seemed known to 3.4 m, and moved the newest state by 4 standard deviations. At 1e-9 rounding can outweigh it: an
/// undetermined depth moved from 3 to 2.3 m in one build of two. At 1e-8 a landmark that is determined later moves the
/// newest state by 0.05 standard deviations.
inline constexpr double kRegularisingDamping = 2e-9;

/// Block Cholesky factorisation of the normal equations in time order. Stage k adds interval k (k−1 → k) and the priors
/// on state k to the root, then eliminates the landmarks that are seen for the last time in k or before, then state
/// k−1. The root after stage k contains state k and the landmarks alive there. Stages form a chain: the separator of
/// stage k is the root after it, and a change in interval k leaves the stages before k unchanged. So does an old
/// landmark that is re-acquired (returns.hpp).
class Factorisation {
 public:
  struct Stage {
    std::vector<Conditional> conditionals;  ///< in the order of elimination
    std::vector<int> entered;               ///< landmarks that entered the root in this stage
    std::vector<int> entered_slots;         ///< their slots
    std::vector<SlotMove> moved;            ///< moves of landmarks, before any elimination
    ReturnRows returned;  ///< landmarks that were eliminated in this stage or before and returned later
    /// Change of the separator since the stage was last solved back (see Engine); infinite once it has been redone.
    double skipped = 0.0;

    int pivots() const;
    /// All conditionals, one after the other; z is pivots × columns.
    void eliminate(double* r, int r_stride, double* z, int columns) const;
    void back_substitute(const double* z, double* delta) const;
    void back_substitute(double* z, double* x, int x_stride, int columns) const;
  };

  /// `grace`: a landmark that is no longer observed stays in the root for this many states [≥ 1]; `state_size`: rows of
  /// a state.
  Factorisation(int grace, int state_size) : grace_(grace), root_(state_size) {}

  /// The last stage that is done, −1: none.
  int done() const { return done_; }
  Stage& stage(int k) { return stages_[index(k)]; }
  const Stage& stage(int k) const { return stages_[index(k)]; }
  const Root& root() const { return root_; }

  void add_landmark();
  /// The stage that eliminated landmark j; none while it is in the root or before its first observation.
  std::optional<int> eliminated_at(int j) const;

  /// An eliminated landmark has been observed again in an interval that is going to be redone: redo() returns it to the
  /// root without redoing the stages since its elimination. Only with full history.
  void bring_back(int j) { called_back_.push_back(j); }
  /// The last stage before `first` from which redo() can continue; −1: none.
  int snapshot_before(int first) const;
  /// The oldest stage that is redone together with `first`, because landmarks have moved since they returned.
  int oldest_redone(int first, const FactorGraph& graph) const;
  bool awaits_return() const { return !called_back_.empty(); }
  Returns& returns() { return returns_; }

  /// Regularises a variable that its factors do not determine: adds weak damping to its diagonal when it is eliminated.
  void regularise(const Variable& variable);
  bool is_regularised(const Variable& variable) const;

  /// Redoes the stages from `first` on, up to the newest state. Returns the variable that made the system singular;
  /// then only stages before its elimination are done. `damping`: λ of Levenberg-Marquardt, relative to the diagonal.
  std::optional<Variable> redo(int first, const FactorGraph& graph, LinearisationPoints& points, double damping);

  /// Factorises the root. Returns the variable that made it singular.
  std::optional<Variable> factorise_root(const LinearisationPoints& points, double damping);

  /// Solves for the increments of the root's variables, in the root's layout; `delta` grows to the root's extent.
  void solve_root(Buffer& delta);
  /// Then for the variables that stage k eliminated, from the newest stage backwards. Afterwards delta is in the layout
  /// before the stage, with these variables in their rows.
  void solve_stage(int k, double* delta);
  /// Exchanges the known values of returned landmarks with those before the last solve.
  void swap_known() { back_.swap_known(returns_); }
  /// How much returned landmarks change the stages that are not solved yet (returns.hpp).
  double change_by_returns() const { return back_.change(); }

  /// A scalar unknown: its row in the layout in which stage `stage` eliminates it (after the last done stage: in the
  /// present root).
  struct Unknown {
    int stage = 0, row = 0;
  };
  /// Joint covariance of unknowns; the one with the earliest stage must be the first.
  Eigen::MatrixXd covariance(std::span<const Unknown> unknowns) const;

  /// Joint covariances of states k − 1 and k for k = first, first + 1, ..., done(), by one backward pass that inverts
  /// selected blocks only. It costs about as much as the stages did.
  std::vector<PairMatrix> chain(int first) const;

  /// Covariance of J x for x in these rows of the present root.
  Eigen::MatrixXd image_in_root(std::span<const int> rows, const Eigen::MatrixXd& J) const;

  /// The first of a landmark's three unknowns, where it is eliminated or in the root.
  std::optional<Unknown> find_landmark(int j) const;

  /// Marginalises the stages up to the newest snapshot not after `stage`. Their information about the variables in the
  /// root there stays as a linear prior, the base. Returns the stage of the base.
  int marginalise(int stage);

  /// The stage whose root is the base; −1: full history.
  int base() const { return base_; }
  bool in_base(const Variable& variable) const;
  /// Was landmark j eliminated before the base? It can no longer be observed.
  bool is_marginalised(int j) const { return landmarks_[index(j)].marginalised; }
  /// Moves the linearisation point of a variable of the base by `shift`.
  void shift_base(const Variable& variable, const double* shift);
  /// The graph has another scale anchor. The information of a marginalised one stays in the base.
  void renew_anchor() { anchor_in_base_ = false; }

  std::int64_t stages_done() const { return stages_done_; }

 private:
  static constexpr int kThinnedUpTo = 136;  ///< [stages] the spacing of older snapshots no longer changes

  struct LandmarkStatus {
    int eliminated_at = -1;
    bool regularised = false, marginalised = false;
  };
  void solve_with_root_factor(double* x) const;
  Eigen::MatrixXd root_covariance() const;
  void add_return_moments(int position, Eigen::MatrixXd& S) const;
  int update_anchor_stage(const FactorGraph& graph);
  int go_back_to(int first, const FactorGraph& graph);
  int take_back_returns(const FactorGraph& graph);
  std::optional<int> bring_all_back(const FactorGraph& graph, const LinearisationPoints& points);
  bool bring_back_again(Return&& known, const LinearisationPoints& points);
  std::optional<int> walk_and_bring_back(const FactorGraph& graph, const LinearisationPoints& points);
  void keep_checkpoints(int k, Walk& walk, std::vector<Return>& coming) const;
  void add_returned_factors(int first);
  Return* bring_back(Return&& result, Walk& walk);
  Buffer increments_of_root(const LinearisationPoints& points) const;
  std::optional<Variable> do_stage(int k, const FactorGraph& graph, LinearisationPoints& points, double damping);
  void add_factors(int k, const FactorGraph& graph, LinearisationPoints& points);
  void add_anchor(const FactorGraph& graph, const LinearisationPoints& points);
  void enter(int j, const FactorGraph& graph, const LinearisationPoints& points);
  void find_finished(int k, const FactorGraph& graph);
  std::optional<Variable> eliminate_finished(int k, const LinearisationPoints& points, double damping);
  double damping_of(const Variable& variable, double damping) const;
  void damp(const Variable& variable, const LinearisationPoints& points, double damping);
  void keep_snapshot(int k, int newest);
  void thin_snapshots(int newest);
  int last_interval(int j, const FactorGraph& graph) const;
  int row_in_base(const Variable& variable) const;

  int grace_;
  int done_ = -1;
  int base_ = -1;
  bool anchor_in_base_ = false;
  int anchor_stage_ = -1;  ///< the stage that adds the scale anchor: its last landmark enters there
  Root root_;
  std::vector<Stage> stages_;
  std::vector<LandmarkStatus> landmarks_;
  std::vector<bool> regularised_states_;
  std::map<int, Root::Snapshot> snapshots_;  ///< the root after a stage
  std::vector<Root::Snapshot> spare_;        ///< their memory, for reuse
  std::vector<int> finished_;                ///< landmarks to eliminate in the present stage
  RootFactor factor_;
  Returns returns_;
  std::vector<Return> taken_back_;  ///< of stages that are being redone
  std::vector<int> called_back_;    ///< landmarks that have not returned yet
  EstimatePass back_;
  Buffer right_hand_side_;
  std::int64_t stages_done_ = 0;
};

}  // namespace evbench::smoother
