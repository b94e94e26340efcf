#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <memory>

#include "bench/commands/commands.hpp"
#include "core/data/pose_file.hpp"
#include "core/io/atomic_file.hpp"
#include "eval/protocol.hpp"
#include "eval/run_record.hpp"

namespace evbench {
namespace {

/// The command line, in evo's words.
struct EvalArguments {
  std::string ground_truth, estimate;
  std::string format = "auto", times, ground_truth_unit = "auto", estimate_unit = "auto";
  bool align = false, correct_scale = false, align_origin = false;
  bool interpolate = false, all_pairs = false, pairs_from_reference = false;
  int n_to_align = -1;
  double t_start = -std::numeric_limits<double>::infinity(), t_end = std::numeric_limits<double>::infinity();
  std::string alignment;
  std::string delta_unit = "f";
  std::string json;
  ScoreOptions options = {.rpe_delta = 1.0};  ///< what goes straight into the protocol
};

/// The value with this name; CLI11 has checked that there is one.
template <class Enum, std::size_t count>
Enum named(const std::array<const char*, count>& names, const std::string& name) {
  return static_cast<Enum>(std::ranges::find(names, name) - names.begin());
}

PoseFile read_file(const std::string& path, const std::string& unit, const EvalArguments& arguments) {
  PoseFileOptions options;
  options.format = named<PoseFormat>(kPoseFormatNames, arguments.format);
  options.time_unit = named<TimeUnit>(kTimeUnitNames, unit);
  options.times = arguments.times;
  options.may_number = true;
  return read_poses(path, options);
}

/// Where neither file has times, poses go together by their numbers.
void check_numbers(const PoseFile& ground_truth, const PoseFile& estimate, const EvalArguments& arguments) {
  if (ground_truth.numbered != estimate.numbered) {
    throw InputError(fmt::format("{}: has no times, as the other trajectory has; expected --times with a time a pose",
                                 estimate.numbered ? arguments.estimate : arguments.ground_truth));
  }
  const std::size_t poses = estimate.trajectory.size(), expected = ground_truth.trajectory.size();
  if (!estimate.numbered || poses == expected) return;
  throw InputError(fmt::format("{}: has {} poses without times; expected {}, as the ground truth has, or --times",
                               arguments.estimate, poses, expected));
}

std::string alignment_name(const EvalArguments& arguments) {
  if (!arguments.alignment.empty()) return arguments.alignment;
  if (arguments.align_origin) return "origin";
  if (arguments.align) return arguments.correct_scale ? "sim3" : "se3";
  return arguments.correct_scale ? "scale" : "none";
}

std::string unit_name(const std::string& letter) {
  for (const char* unit : kDeltaUnitNames) {
    if (letter[0] == unit[0]) return unit;
  }
  return letter;
}

ScoreOptions score_options(const EvalArguments& arguments) {
  ScoreOptions options = arguments.options;
  options.alignment = alignment_name(arguments);
  options.align_first = std::max(arguments.n_to_align, 0);
  options.association = arguments.interpolate ? "interpolated" : "nearest";
  if (std::isfinite(arguments.t_start) || std::isfinite(arguments.t_end)) {
    options.time_range = {arguments.t_start, arguments.t_end};
  }
  options.rpe_unit = unit_name(arguments.delta_unit);
  options.rpe_pairing = arguments.all_pairs ? "all" : "consecutive";
  options.rpe_pairs_from = arguments.pairs_from_reference ? "ground_truth" : "estimate";
  return options;
}

/// Errors name the estimate's file, as those of reading do.
Scores score_files(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate, const EvalArguments& arguments) {
  try {
    return score(ground_truth, estimate, score_options(arguments));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", arguments.estimate, error.what()));
  }
}

/// What only a run knows is left open.
RunRecord record_of(const EvalArguments& arguments, const Scores& scores) {
  RunRecord record;
  record.experiment = arguments.ground_truth;
  record.label = arguments.estimate;
  record.final_scores = to_json(scores);
  return record;
}

void execute(const EvalArguments& arguments) {
  const PoseFile ground_truth = read_file(arguments.ground_truth, arguments.ground_truth_unit, arguments);
  const PoseFile estimate = read_file(arguments.estimate, arguments.estimate_unit, arguments);
  check_numbers(ground_truth, estimate, arguments);
  const Scores scores = score_files(ground_truth.trajectory, estimate.trajectory, arguments);
  for (const PoseFile* file : {&ground_truth, &estimate}) {
    for (const std::string& remark : file->remarks) fmt::print(stderr, "remark: {}\n", remark);
  }
  if (!arguments.json.empty()) write_file(arguments.json, to_json(record_of(arguments, scores)).dump(2) + "\n");
  if (arguments.json == "/dev/stdout") return;
  fmt::print("ground truth {}\nestimate     {}\n{}", arguments.ground_truth, arguments.estimate, describe(scores));
}

void add_file_options(CLI::App& command, EvalArguments& arguments) {
  command
      .add_option(
          "--format", arguments.format,
          "Columns of both files: tum (t x y z qx qy qz qw), euroc (t x y z qw qx qy qz), kitti (3x4 matrices), "
          "robotevt (t r11..r33 x y z); auto: as their names or number tell")
      ->check(CLI::IsMember(to_strings(kPoseFormatNames)))
      ->capture_default_str();
  command.add_option("--times", arguments.times, "Times, one a line, of trajectories without (KITTI)")
      ->type_name("FILE");
  const auto add_unit = [&](const char* name, std::string& unit, const std::string& whose) {
    command.add_option(name, unit, "Unit of the " + whose + "'s times; auto: as their column's name says, or seconds")
        ->check(CLI::IsMember(to_strings(kTimeUnitNames)))
        ->capture_default_str();
  };
  add_unit("--groundtruth_unit", arguments.ground_truth_unit, "ground truth");
  add_unit("--estimate_unit", arguments.estimate_unit, "estimate");
}

void add_alignment_options(CLI::App& command, EvalArguments& arguments) {
  auto* align = command.add_flag("-a,--align", arguments.align, "SE(3) alignment (Umeyama); with -s: Sim(3)");
  auto* scale =
      command.add_flag("-s,--correct_scale", arguments.correct_scale, "Correct the scale; without -a: it alone");
  auto* origin = command.add_flag("--align_origin", arguments.align_origin, "Make the first poses equal");
  origin->excludes(align)->excludes(scale);
  command.add_option("--alignment", arguments.alignment, "The same by name, and yaw only (about z)")
      ->check(CLI::IsMember(to_strings(kAlignmentNames)))
      ->excludes(align)
      ->excludes(scale)
      ->excludes(origin);
  auto* first = command.add_option("--n_to_align", arguments.n_to_align, "Align on this many first poses; -1: all")
                    ->check(CLI::Range(-1, std::numeric_limits<int>::max()));
  command.add_option("--align_range", arguments.options.align_range, "Align on the poses between two times [s]")
      ->expected(2)
      ->type_name("FROM TO")
      ->excludes(first);
}

void add_association_options(CLI::App& command, EvalArguments& arguments) {
  ScoreOptions& options = arguments.options;
  command.add_option("--t_max_diff", options.tolerance, "Ground truth at most this far in time from a pose [s]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_option("--t_offset", options.time_offset, "Added to the estimate's times [s]")->capture_default_str();
  command.add_option("--t_start", arguments.t_start, "Use ground truth from this time on [s]");
  command.add_option("--t_end", arguments.t_end, "Use ground truth up to this time [s]");
  command.add_flag("--interpolate", arguments.interpolate, "Interpolate the ground truth at the estimate's times");
}

void add_relative_options(CLI::App& command, EvalArguments& arguments) {
  ScoreOptions& options = arguments.options;
  command.add_option("-d,--delta", options.rpe_delta, "Distance of the two poses of a relative error")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command.add_option("-u,--delta_unit", arguments.delta_unit, "Unit of delta: frames, seconds, metres, degrees")
      ->check(CLI::IsMember({"f", "s", "m", "d"}))
      ->capture_default_str();
  command.add_option("-t,--delta_tol", options.rpe_tolerance, "How far from delta a pair may be, relative to it")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_flag("--all_pairs", arguments.all_pairs, "Pairs from every pose on, not one chain");
  command.add_flag("--pairs_from_reference", arguments.pairs_from_reference,
                   "Measure metres and degrees on the ground truth, not on the estimate");
}

}  // namespace

void add_eval(CLI::App& app) {
  auto arguments = std::make_shared<EvalArguments>();
  CLI::App* command = app.add_subcommand("eval", "Score a trajectory: ATE and RPE, with evo's options and numbers");
  command->add_option("groundtruth", arguments->ground_truth, "Ground truth")->required();
  command->add_option("estimate", arguments->estimate, "Estimated trajectory")->required();
  add_file_options(*command, *arguments);
  add_alignment_options(*command, *arguments);
  add_association_options(*command, *arguments);
  add_relative_options(*command, *arguments);
  command->add_option("--json", arguments->json, "Write the scores, with the structure of a run's metrics.json");
  command->footer("As evo does, nothing is aligned unless asked for: monocular estimates need -as.");
  command->callback([arguments] { execute(*arguments); });
}

}  // namespace evbench
