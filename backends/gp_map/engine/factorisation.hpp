#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "backends/gp_map/engine/conditional.hpp"
#include "backends/gp_map/engine/linearisation_points.hpp"
#include "backends/gp_map/engine/returns.hpp"
#include "backends/gp_map/engine/root_factor.hpp"

namespace evbench::gp_map {

/// A state or a landmark.
struct Variable {
  enum class Kind { state, landmark };
  Kind kind = Kind::state;
  int index = 0;
  std::string name() const;
  bool operator==(const Variable&) const = default;
};

/// Damping of variables that are held. They stay so when observations determine them later: at 1e-6 a landmark known to
/// 20 m seemed known to 3.4 m, and moved the newest state by 4 standard deviations.
/// At 1e-9 rounding can outweigh it: a depth that nothing determined moved from 3 to 2.3 m in one build of two. At 1e-8 a
/// landmark that is determined later moves the newest state by 0.05 standard deviations.
inline constexpr double kHoldDamping = 3e-9;

/// The block Cholesky factorisation of the normal equations in the order of time. Stage k adds interval k (k−1 → k) and
/// the priors on state k to the root, eliminates the landmarks that are seen for the last time in k or before, then
/// state k−1. What remains after stage k is the root: state k and the landmarks alive there. Stages form a chain: the
/// separator of stage k is the root after it, and a change in interval k leaves the stages before k as they are. So
/// does an old landmark that is seen again (returns.hpp).
class Factorisation {
 public:
  struct Stage {
    std::vector<Conditional> conditionals;  ///< in the order of elimination
    std::vector<int> entered;               ///< landmarks that came into the root in this stage
    std::vector<int> entered_slots;         ///< and where
    std::vector<SlotMove> moved;            ///< landmarks, before anything was eliminated
    ReturnRows returned;  ///< landmarks that had been eliminated in this stage or before, and came back
    /// Change of the separator since the stage was last solved back (see Engine); infinite once it has been redone.
    double skipped = 0.0;

    int pivots() const;
    /// Of all conditionals, one after the other; z is pivots × columns.
    void eliminate(double* r, int r_stride, double* z, int columns) const;
    void back_substitute(const double* z, double* delta) const;
    void back_substitute(double* z, double* x, int x_stride, int columns) const;
  };

  /// A landmark that is not observed any more stays in the root for this many states [≥ 1].
  explicit Factorisation(int grace) : grace_(grace) {}

  /// The last stage that is done, −1: none.
  int done() const { return done_; }
  Stage& stage(int k) { return stages_[index(k)]; }
  const Stage& stage(int k) const { return stages_[index(k)]; }
  const Root& root() const { return root_; }

  void add_landmark();
  /// The stage that eliminates it; none while it is in the root or before it has been seen.
  std::optional<int> eliminated_at(int j) const;

  /// An eliminated landmark has been observed again in an interval that is going to be redone: redo() brings it back
  /// into the root without redoing the stages since its elimination. Of a full history only.
  void bring_back(int j) { called_back_.push_back(j); }
  /// The last stage before this one from which redo() can go on; −1: none.
  int snapshot_before(int first) const;
  /// The oldest stage that is redone if this one is, because landmarks have moved since they came back.
  int oldest_redone(int first, const FactorGraph& graph) const;
  bool awaits_return() const { return !called_back_.empty(); }
  Returns& returns() { return returns_; }

  /// Adds this share to the diagonal when the variable is eliminated: for what its factors leave undetermined.
  void hold(const Variable& variable);
  bool is_held(const Variable& variable) const;

  /// Redoes the stages from `first` on, up to the newest state. Returns what made the system singular; then only stages
  /// before that variable's elimination are done. `damping`: λ of Levenberg-Marquardt, relative to the diagonal.
  std::optional<Variable> redo(int first, const FactorGraph& graph, LinearisationPoints& points, double damping);

  /// Factorises the root. Returns what made it singular.
  std::optional<Variable> factorise_root(const LinearisationPoints& points, double damping);

  /// The increments of the root's variables, in the root's layout; `delta` grows to the root's extent.
  void solve_root(Buffer& delta);
  /// Then those of the variables that stage k eliminated, from the newest stage backwards; delta then is in the layout
  /// before the stage, and still has them in their rows.
  void solve_stage(int k, double* delta);
  /// Exchanges what is known of landmarks that came back with that of before the last solve.
  void swap_known() { back_.swap_known(returns_); }
  /// How much what was learnt from landmarks that came back changes the stages that are not solved yet (returns.hpp).
  double change_by_returns() const { return back_.change(); }

  /// A scalar unknown: its row in the layout in which stage `stage` eliminates from the root (after the last stage
  /// done: the root as it is now).
  struct Unknown {
    int stage = 0, row = 0;
  };
  /// Joint covariance of unknowns, the one with the earliest stage first.
  Eigen::MatrixXd covariance(std::span<const Unknown> unknowns) const;

  /// Joint covariances of states k − 1 and k for k = first, first + 1, ..., done(): one walk backwards that inverts
  /// selected blocks only, about as dear as the stages were.
  std::vector<Matrix24> chain(int first) const;

  /// Covariance of J x for x in these rows of the root as it is now.
  Eigen::MatrixXd image_in_root(std::span<const int> rows, const Eigen::MatrixXd& J) const;

  /// The first of a landmark's three where it is eliminated, or in the root.
  std::optional<Unknown> find_landmark(int j) const;

  /// Forgets the stages up to the newest snapshot not after `stage`: what they say about the variables in the root
  /// there stays as a linear prior, the base. Returns the base's stage.
  int marginalise(int stage);

  /// The stage whose root is the base; −1: full history.
  int base() const { return base_; }
  bool in_base(const Variable& variable) const;
  /// A landmark that was eliminated before the base can't be observed any more.
  bool is_forgotten(int j) const { return landmarks_[index(j)].forgotten; }
  /// A variable of the base is linearised at a point that lies `shift` further (12 or 3).
  void shift_base(const Variable& variable, const double* shift);
  /// The graph has got another scale anchor: what one that has been marginalised says stays in the base.
  void renew_anchor() { anchor_in_base_ = false; }

  std::int64_t stages_done() const { return stages_done_; }

 private:
  static constexpr int kThinnedUpTo = 136;  ///< age of snapshots beyond which their spacing doesn't change any more

  struct LandmarkStatus {
    int eliminated_at = -1;
    bool held = false, forgotten = false;
  };
  void solve_with_root_factor(double* x) const;
  Eigen::MatrixXd root_covariance() const;
  void add_return_moments(int position, Eigen::MatrixXd& S) const;
  int place_anchor(const FactorGraph& graph);
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
  int anchor_stage_ = -1;  ///< where the scale anchor is added: its last landmark has come in
  Root root_;
  std::vector<Stage> stages_;
  std::vector<LandmarkStatus> landmarks_;
  std::vector<bool> held_states_;
  std::map<int, Root::Snapshot> snapshots_;  ///< the root after a stage
  std::vector<Root::Snapshot> spare_;        ///< their memory, to use again
  std::vector<int> finished_;                ///< landmarks to eliminate in the stage at hand
  RootFactor factor_;
  Returns returns_;
  std::vector<Return> taken_back_;  ///< of stages that are being redone
  std::vector<int> called_back_;    ///< landmarks that have not come back yet
  EstimatePass back_;
  Buffer right_hand_side_;
  std::int64_t stages_done_ = 0;
};

}  // namespace evbench::gp_map
