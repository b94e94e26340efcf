#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/motion/pose_trajectory.hpp"
#include "core/plugin/options.hpp"
#include "eval/alignment.hpp"
#include "eval/pose_error.hpp"
#include "eval/segment_error.hpp"
#include "eval/statistics.hpp"
#include "eval/velocity_error.hpp"

namespace evbench {

/// The protocol of an evaluation: the key "evaluation" of a run's config. The defaults are for monocular back-ends.
struct ScoreOptions {
  std::string protocol = "none";
  std::string alignment = "sim3";
  int align_first = 0;
  OptionSet::List align_range = {};
  OptionSet::List align_seconds = {};
  std::string association = "nearest";
  double tolerance = 0.01;
  double time_offset = 0.0;
  OptionSet::List time_range = {};
  int min_pairs = 3;
  double latency = 0.2;
  double rpe_delta = 0.1;
  std::string rpe_unit = "seconds";
  std::string rpe_pairing = "all";
  double rpe_tolerance = 0.1;
  std::string rpe_pairs_from = "estimate";
  std::string segments = "none";
  OptionSet::List segment_lengths = {};
  std::string segment_unit = "metres";

  void declare(OptionSet& set);
};

struct AbsoluteScores {
  Statistics trans_m, rot_deg;
  Statistics rot_centred_deg;  ///< of rotation, without the common rotation error of all poses (common_rotation)
  double trans_percent = Statistics::kUndefined;  ///< trans_m.rmse in percent of path_m; undefined if path_m is 0
};

/// Mean errors relative to the length of the ground truth's path; undefined if that is 0.
struct MeanErrors {
  double mpe_percent = Statistics::kUndefined;    ///< of position
  double mre_deg_per_m = Statistics::kUndefined;  ///< of rotation
  double mye_deg_per_m = Statistics::kUndefined;  ///< of yaw, about the ground truth's z axis
};

struct RelativeScores {
  Statistics trans_m, rot_deg;  ///< of an empty set if no two poses are delta apart
};

/// Errors over sub-trajectories, relative to their length.
struct SegmentScores {
  double length_m = 0.0;
  Statistics trans_percent, rot_deg_per_m;
};

/// Scores of a trajectory, with the protocol and counts that are needed to interpret them.
struct Scores {
  AbsoluteScores ate;
  MeanErrors mean;
  RelativeScores rpe;
  std::optional<VelocityScores> velocity;  ///< set by score_velocities()
  SegmentScores all_segments;              ///< of all lengths together
  std::vector<SegmentScores> by_length;    ///< empty if not requested
  std::vector<PosePair> compared;          ///< the compared poses; those of the estimate are aligned
  std::size_t pairs = 0;                   ///< poses compared
  std::size_t unmatched = 0;               ///< poses of the estimate that are not compared
  double coverage = 0.0;                   ///< share of the ground truth's time that they cover (association.hpp)
  double path_m = 0.0;                     ///< length of the ground truth through the compared poses
  double ground_truth_path_m = 0.0;        ///< through all of its poses in the protocol's time range
  Alignment alignment;                     ///< applied to the estimate
  std::size_t aligned_pairs = 0;           ///< poses that it was computed on
  ScoreOptions options;                    ///< the protocol
};

/// The options of relative errors in a protocol. Throws InputError for unknown names.
RelativeOptions relative_options(const ScoreOptions& options);

/// Associates, aligns, and computes the errors. Throws InputError for contradictory options or options out of range,
/// and for trajectories that can't be compared (association.hpp, alignment.hpp). The same input gives identical digits.
Scores score(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate, const ScoreOptions& options = {});

/// Adds the scores of the velocities at the compared poses, at the scale of the alignment, to `scores` of the same
/// trajectories. `true_velocities`: of the ground truth; empty: it is differentiated. `own`: body velocities that the
/// estimate states, by time of the estimate; empty: it states none.
void score_velocities(const PoseTrajectory& ground_truth, const BodyVelocities& true_velocities,
                      const PoseTrajectory& estimate, const BodyVelocities& own, Scores& scores);

/// The structure that docs/reference/metrics.md documents.
Json to_json(const Scores& scores);

}  // namespace evbench
