#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/smoother/engine/conditional.hpp"

namespace evbench::smoother {

/// Three values of a landmark for each of up to 36 right-hand sides.
using Known3 = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 36>;
using MatrixX3 = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// Coupling of a stage's noise with landmarks that returned later (see Returns): Zᵀ, 3 rows for each of them.
struct ReturnRows {
  std::vector<int> ids;
  Buffer Zt;       ///< by columns, one per pivot of the stage
  int stride = 0;  ///< padded; rows beyond those in use are zero

  void clear();
  void append(int id, const double* Z, int pivots);
};

struct Return;
class Returns;

/// Carries right-hand sides forward through the stages, across the returns.
class ForwardPass {
 public:
  /// Starts at this stage.
  ForwardPass(const Returns& returns, int stage, int columns);
  /// Takes these columns of another pass; they are zero before this later stage.
  ForwardPass(const ForwardPass& all, int stage, int column, int columns);

  /// z: the part of the right-hand sides that the stage's pivots took, pivots × columns.
  void add(const ReturnRows& stage, const double* z, int pivots);
  /// Crosses the returns before stage k. x is in the root's layout there, with this stride between right-hand sides.
  void cross(int k, double* x, int stride);

  int first() const { return first_; }  ///< position of the first return that may be crossed
  auto g() const { return g_.topRows(3 * (next_ - first_)); }
  auto sum(int id) { return sums_.middleRows<3>(3 * id); }  ///< Σ Zᵀ z over the noise that is coupled with the return
  /// Restores the state before the returns before stage k; g begins with its values then.
  void resume(int k, const Eigen::Ref<const Eigen::MatrixXd>& g);

 private:
  const Returns& returns_;
  int first_, next_;
  Eigen::MatrixXd sums_, g_;
  Buffer product_;
};

/// Carries right-hand sides backward: solves for μ, the latest return first.
class BackwardPass {
 public:
  /// g: of the returns from position `first` on, a column per right-hand side. Earlier returns are not reached.
  void start(const Returns& returns, int first, Eigen::MatrixXd g);
  /// Crosses the returns before stage k. x is in the root's layout there, with this stride between right-hand sides.
  void cross(const Returns& returns, int k, const double* x, int stride);
  /// z += Z μ, pivots × columns.
  void shift(const ReturnRows& stage, double* z, int pivots);

 protected:
  /// The next return to cross, if it is before stage k; null: none.
  const Return* next(const Returns& returns, int k) const;
  /// Crosses it: `known` is Rᵀ x there.
  void cross(const Return& last, Known3 known);
  /// μ of the returns that are coupled with the stage.
  const Eigen::MatrixXd& gather(const ReturnRows& stage);

  int next_ = 0;

 private:
  int first_ = 0;
  Eigen::MatrixXd g_;         ///< increased by the contributions of later returns
  Eigen::MatrixXd mu_;        ///< by id
  Eigen::MatrixXd gathered_;  ///< of one stage
};

/// The backward pass of the estimate. It stores the known values of each return for the next pass.
class EstimatePass : private BackwardPass {
 public:
  void start(const Returns& returns);
  /// Crosses the returns before stage k; delta in the root's layout there.
  void cross(Returns& returns, int k, const double* delta);
  /// z += Z μ.
  void shift(const ReturnRows& stage, double* z, int pivots);
  /// Exchanges the stored values with those that they replaced.
  void swap_known(Returns& returns) const;

  /// Change of the noise of the stages that have not been shifted yet, due to the known values of the returns [standard
  /// deviations, norm over all of them].
  double change() const { return std::sqrt(std::max(0.0, change2_)); }

 private:
  Eigen::VectorXd shift_change_;
  double change2_ = 0.0;
};

/// Eliminated landmarks carried forward together, 3 columns each: ℓ = xᵀ δ_root + Σ_k Z_kᵀ (y_k + w_k).
struct Walk {
  /// Starts at this stage; x has this many rows.
  Walk(const Returns& returns, int stage, int rows, int landmarks);
  /// One landmark of a walk, which began at this stage; x has this many rows, not fewer than before.
  Walk(const Walk& all, int landmark, int stage, int rows);

  ForwardPass pass;
  Eigen::MatrixXd x;
  Eigen::MatrixXd square;  ///< Σ Zᵀ Z
  Eigen::VectorXd with_y;  ///< Σ Zᵀ y
};

/// A landmark that was eliminated and has returned to the root.
struct Return {
  /// The walk up to an earlier stage, so that the landmark can return there instead.
  struct Checkpoint {
    int stage = 0;
    MatrixX3 x;
    Matrix3 square;
    Vector3 with_y;
    std::vector<std::pair<int, Matrix3>> sums;  ///< by the ids of returns that were not crossed yet
  };

  int id = 0;
  int landmark = 0;
  int from = 0;                         ///< the stage that eliminated it
  int before = 0;                       ///< it is in the root again before this stage
  int slot = 0;                         ///< its slot there
  int first = 0;                        ///< position of the first return crossed by its walk
  MatrixX3 g;                           ///< row f of L, transposed, from `first` on
  Matrix3 L;                            ///< and its diagonal block
  MatrixX3 R;                           ///< in the root's layout
  Vector3 mean = Vector3::Zero();       ///< L⁻¹ Σ Zᵀ w = Rᵀ δ − mean
  std::vector<Checkpoint> checkpoints;  ///< by stage

  /// Change of the landmark's linearisation point since its return.
  Vector3 offset = Vector3::Zero();
  Vector3 known_before = Vector3::Zero();  ///< the same at the solve before
  Vector3 known = Vector3::Zero();         ///< Rᵀ δ − mean when the stages before were last solved
  Vector3 delta_before = Vector3::Zero();  ///< increment of the eliminated landmark when it was last solved for
};

/// Landmarks that are re-acquired long after their elimination. Let w = Lᵀ δ_p + Aᵀ δ_r − y be the noise of a stage:
/// given the root after it, w has zero mean and unit covariance and is independent of other stages. Carried forward
/// through the stages, an eliminated landmark is a linear function of the root and of this noise (Walk). So p(ℓ | root)
/// enters the root as a factor, and the root becomes what it would be if the landmark had never left. Older stages stay
/// unchanged, but the mean of their noise is no longer zero: given ℓ and the root it is Z μ.
///
/// For all returns f, in their order: K_ef = Σ_k Z_ekᵀ Z_fk (over the stages before the earlier one), K = L Lᵀ by
/// blocks of 3. L⁻¹ Σ Zᵀ w, again of unit covariance, is known from the root's variables at each return: Rᵀ δ − mean.
/// Then μ = L⁻ᵀ (Rᵀ δ − mean). A right-hand side that is carried forward across a return, with z in place of a walk's
/// Z, adds R g to its x, with g = L⁻¹ Σ Zᵀ z. For a later return this g is its row of L, for y the mean.
class Returns {
 public:
  const Return& operator[](int position) const { return returns_[index(position)]; }
  Return& operator[](int position) { return returns_[index(position)]; }
  int size() const { return static_cast<int>(returns_.size()); }
  int ids() const { return ids_; }
  /// The position of the first return before a stage later than this.
  int first_after(int stage) const;
  Eigen::VectorXd means() const;
  /// The return of a landmark that stage `from` had eliminated.
  Return* find(int landmark, int from);
  /// The last return of a landmark; null: none.
  Return* last_of(int landmark);

  int new_id();
  void free_id(int id) { free_.push_back(id); }

  /// Adds the return of a landmark with this walk, which has crossed all others, into the landmark's slot; R has
  /// `root.extent()` rows. Returns null and does nothing if the other returns leave too little of it unknown to be
  /// distinguished from rounding.
  Return* append(Return&& result, const Walk& walk, const Root& root);

  /// Removes and returns those before stages later than `done`, in order.
  std::vector<Return> take_after(int done);

  /// Drops checkpoints before this stage.
  void thin(int stage);

 private:
  std::vector<Return> returns_;  ///< by stage
  std::vector<int> free_;        ///< ids for reuse
  int ids_ = 0;
};

}  // namespace evbench::smoother
