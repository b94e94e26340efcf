#pragma once

#include <string>
#include <vector>

#include "core/motion/pose_trajectory.hpp"
#include "core/plugin/options.hpp"
#include "eval/alignment.hpp"
#include "eval/pose_error.hpp"
#include "eval/segment_error.hpp"
#include "eval/statistics.hpp"

namespace evbench {

/// The protocol of an evaluation: the key "evaluation" of a run's config. The defaults are for monocular back-ends.
struct ScoreOptions {
  std::string alignment = "sim3";
  int align_first = 0;
  OptionSet::List align_range = {};
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

  void declare(OptionSet& set) {
    set.add("alignment", alignment, "how the estimate is carried to the ground truth")
        .choices(to_strings(kAlignmentNames));
    set.add("align_first", align_first, "align on this many first poses only; 0: on all").range(0);
    set.add("align_range", align_range, "align on the poses in this time range only [s]; empty: on all")
        .size(2)
        .rising();
    set.add("association", association, "which ground truth a pose is compared with")
        .choices(to_strings(kAssociationNames));
    set.add("tolerance", tolerance, "no ground truth this near in time to a pose: it is not compared [s]").range(0.0);
    set.add("time_offset", time_offset, "added to the estimate's times [s]");
    set.add("time_range", time_range, "evaluate in this time range of the ground truth only [s]; empty: all")
        .size(2)
        .rising();
    set.add("min_pairs", min_pairs, "fewer compared poses are an error").range(3);
    set.add("latency", latency,
            "how long one waits for each online pose, the same for all back-ends of a table: scores at equal latency "
            "[s]")
        .range(0.0, 10.0);
    set.add("rpe_delta", rpe_delta, "distance of the two poses of a relative error [rpe_unit]").above(0.0);
    set.add("rpe_unit", rpe_unit, "what that distance is measured in").choices(to_strings(kDeltaUnitNames));
    set.add("rpe_pairing", rpe_pairing, "from every pose, or in one chain").choices(to_strings(kPairingNames));
    set.add("rpe_tolerance", rpe_tolerance, "how far a pair may be from rpe_delta, relative to it").range(0.0);
    set.add("rpe_pairs_from", rpe_pairs_from, "whose path and angles the distance is measured on, metres and degrees")
        .choices(to_strings(kPairSourceNames));
    set.add("segments", segments, "whose definition of errors over sub-trajectories is added, in % and deg/m")
        .choices(to_strings(kSegmentRuleNames));
    set.add("segment_lengths", segment_lengths,
            "lengths of sub-trajectories [segment_unit]; empty: 10 to 50 % (rpg), 100 to 800 m (kitti)")
        .above(0.0);
    set.add("segment_unit", segment_unit, "what these lengths are in: metres, or percent of the ground truth's path")
        .choices(to_strings(kLengthUnitNames));
  }
};

struct AbsoluteScores {
  Statistics trans_m, rot_deg;
  Statistics rot_centred_deg;  ///< of rotation, without what is the same in all poses (common_rotation)
  double trans_percent = Statistics::kUndefined;  ///< trans_m.rmse in percent of path_m; undefined when path_m is 0
};

struct RelativeScores {
  Statistics trans_m, rot_deg;  ///< of an empty set when no two poses are delta apart
};

/// Errors over sub-trajectories, relative to their length.
struct SegmentScores {
  double length_m = 0.0;
  Statistics trans_percent, rot_deg_per_m;
};

/// What is said of a trajectory, with all that a reader needs to judge it.
struct Scores {
  AbsoluteScores ate;
  RelativeScores rpe;
  SegmentScores all_segments;            ///< of all lengths together
  std::vector<SegmentScores> by_length;  ///< none where they are not asked for
  std::vector<PosePair> compared;        ///< the poses, those of the estimate aligned
  std::size_t pairs = 0;                 ///< poses compared
  double coverage = 0.0;                 ///< share of the ground truth's time that they cover (association.hpp)
  double path_m = 0.0;                   ///< length of the ground truth through the compared poses
  Alignment alignment;                   ///< what was applied to the estimate
  std::size_t aligned_pairs = 0;         ///< poses that it was computed on
  ScoreOptions options;                  ///< the protocol
};

/// How such a protocol takes relative errors. Throws InputError for names that are not known.
RelativeOptions relative_options(const ScoreOptions& options);

/// Associates, aligns, and takes the errors. Throws InputError for options that contradict one another or are out of
/// range, and for trajectories that can't be compared (association.hpp, alignment.hpp). The same input gives the same
/// digits.
Scores score(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate, const ScoreOptions& options = {});

/// The structure that metrics.md documents.
Json to_json(const Scores& scores);

}  // namespace evbench
