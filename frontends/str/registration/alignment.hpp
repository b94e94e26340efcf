#pragma once

#include <cstdint>
#include <vector>

#include "core/plugin/options.hpp"
#include "frontends/str/registration/event_cloud.hpp"
#include "frontends/str/registration/motion_model.hpp"
#include "frontends/str/registration/neighbour_grid.hpp"

namespace evbench::str {

struct AlignmentOptions {
  enum class Distance { point, line } distance = Distance::line;
  bool polarity = true;
  double keep = 1.0;
  double gate = 5.0;
  double last_gate = 2.0;
  double gate_shrinking = 0.8;
  double robust_scale = 0.7;
  double edge_noise = 0.4;
  double cell = 1.5;
  double stale = 0.3;
  int first_queries = 1000;
  int iterations = 40;
  double tolerance = 0.01;

  void declare(OptionSet& set);
};

/// A query and its nearest target under a motion.
struct Match {
  std::uint32_t query, target;
  std::uint32_t cell;          ///< the target's, in the grid
  float squared;               ///< distance² [focal lengths²]
  Eigen::Vector2f at;          ///< the query under the motion
  Eigen::Vector2f difference;  ///< from the target to it
};

/// The result of an alignment.
struct Alignment {
  Matrix3 A = Matrix3::Zero();  ///< the motion's matrix [1/s]
  bool converged = false;
  int iterations = 0;
  double fit = 0.0;       ///< mean weight of the queries, from 0 to 1; of those without a target 0
  double residual = 0.0;  ///< [px] root mean square of the weighted distances of those that count
};

/// Finds the motion that aligns two clouds of events, each event moved by its own time to the reference time. Trimmed
/// iterative closest points (Chetverikov et al. 2005): the nearest target of each query, then least squares over the
/// smallest distances, repeatedly. Matches have a robust weight (Cauchy). For line distances they also have a weight by
/// the local shape of the targets, which lets an event slide along an edge. Where there are many queries, the
/// iterations converge with `first_queries` of them first, and then take a step or two with all.
///
/// Targets are searched in a grid that is built for a motion, and rebuilt when the motion has moved a target by more
/// than `stale` since. Distances are always those under the current motion.
class Aligner {
 public:
  Aligner(const AlignmentOptions& options, double focal_length) : options_(options), focal_length_(focal_length) {}

  /// Sets the cloud that queries are aligned with. Its content is swapped with the previous one's.
  void swap_targets(EventCloud& targets);

  /// The motion start + Σ θ_k G_k with the generators of `model` that aligns the queries with the targets. `duration`
  /// [s]: over which a change of the motion by less than the tolerance is none. `gate` [px]: over which events are
  /// matched at first.
  Alignment align(const EventCloud& queries, MotionModel model, const Matrix3& start, double duration, double gate);

  /// Nearest targets under the motion A, within `gate` [px]; in the order of the queries.
  const std::vector<Match>& match(const EventCloud& queries, const Matrix3& A, double gate);

  /// The fit that queries have under the motion A by chance: they are turned about the optical axis by a radian. Where
  /// targets are dense, this is close to the fit of aligned queries.
  double chance_fit(const EventCloud& queries, const Matrix3& A);

  const EventCloud& targets() const { return targets_; }

  /// Mean distance by which the motion A moves the targets and `cloud` in `duration` [s] [px].
  double mean_motion(const EventCloud& cloud, const Matrix3& A, double duration) const;

 private:
  void build(const Matrix3& A);
  bool is_stale(const Matrix3& A) const;
  template <int P>
  Alignment align_with(const EventCloud& queries, MotionModel model, const Matrix3& start, double duration,
                       double gate);

  AlignmentOptions options_;
  double focal_length_;
  EventCloud targets_;
  std::vector<std::uint8_t> kinds_;
  float longest_ = 0.0F;                                           ///< [s] from the reference time to a target's
  float left_ = 0.0F, right_ = 0.0F, top_ = 0.0F, bottom_ = 0.0F;  ///< of the targets
  bool built_ = false;
  Matrix3 built_for_ = Matrix3::Zero();
  NeighbourGrid grid_;
  std::vector<float> target_x_, target_y_;  ///< under the motion that the grid is for
  std::vector<float> query_x_, query_y_;
  std::vector<Match> matches_;
  /// The pull of a match on the motion.
  struct Pull {
    Eigen::Vector2f difference;  ///< [px] between the query and its target
    float between;               ///< [s] time between the two
    Eigen::Matrix2f weight;
    Eigen::Vector2f at;  ///< the query under the motion
    float squared = 0.0F;
  };
  void pull(const EventCloud& queries, const Matrix3& A);
  float weight_of(const Pull& pull) const;

  std::vector<Pull> pulls_;
  std::vector<float> sorted_;
};

/// d(x, y) of the ray (x, y, 1) under d ray = M (x, y, 1).
inline Eigen::Vector2f flow(const Eigen::Matrix3f& M, float x, float y) {
  const float w = M(2, 0) * x + M(2, 1) * y + M(2, 2);
  return {M(0, 0) * x + M(0, 1) * y + M(0, 2) - x * w, M(1, 0) * x + M(1, 1) * y + M(1, 2) - y * w};
}

}  // namespace evbench::str
