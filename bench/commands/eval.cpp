#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <set>

#include "bench/commands/commands.hpp"
#include "bench/commands/failures.hpp"
#include "bench/commands/name_check.hpp"
#include "bench/commands/number_check.hpp"
#include "bench/commands/protocol_option.hpp"
#include "bench/commands/run_outputs.hpp"
#include "bench/figures/run_figures.hpp"
#include "core/data/pose_file.hpp"
#include "core/data/tum.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/index.hpp"
#include "core/support/json.hpp"
#include "eval/error_files.hpp"
#include "eval/fit_offset.hpp"
#include "eval/json_file.hpp"
#include "eval/protocol.hpp"
#include "eval/protocols.hpp"
#include "eval/quaternion_order.hpp"
#include "eval/score_run.hpp"
#include "eval/table.hpp"

namespace evbench {
namespace {

/// Arguments, named as in evo.
struct EvalArguments {
  std::string ground_truth;
  std::vector<std::string> estimates;
  std::string format = "auto", times, ground_truth_unit = "auto", estimate_unit = "auto";
  std::string ground_truth_quaternion = "auto", estimate_quaternion = "auto";
  bool align = false, correct_scale = false, align_origin = false;
  bool interpolate = false, all_pairs = false, pairs_from_reference = false;
  int n_to_align = -1;
  std::optional<double> t_start, t_end, fit_offset;
  std::string alignment, protocol;
  bool velocities = false;
  std::string delta_unit = "f";
  std::string table;  ///< format; empty: a table of several estimates, all numbers of one
  TableLayout layout;
  bool wide = false;
  std::string json, aligned, errors;
  std::string plot, plot_kind = "trajectory";
  bool no_caption = false, force = false;
  ScoreOptions options = {.rpe_delta = 1.0};  ///< options that are stored directly in the protocol
};

PoseFile read_file(const std::string& path, const std::string& unit, const std::string& quaternion,
                   const EvalArguments& arguments) {
  PoseFileOptions options;
  options.format = parse_name<PoseFormat>(kPoseFormatNames, arguments.format, "format");
  options.quaternion = parse_name<QuaternionOrder>(kQuaternionOrderNames, quaternion, "order of a quaternion");
  options.time_unit = parse_name<TimeUnit>(kTimeUnitNames, unit, "unit of time");
  options.times = arguments.times;
  options.may_number = true;
  options.may_lack_unit = true;
  options.velocities = arguments.velocities;
  return read_poses(path, options);
}

void print_remarks(const PoseFile& file) {
  for (const std::string& remark : file.remarks) fmt::print(stderr, "remark: {}\n", remark);
}

/// If neither file has times, poses are associated by their numbers.
void check_numbers(const PoseFile& ground_truth, const PoseFile& estimate, const std::string& path,
                   const EvalArguments& arguments) {
  if (ground_truth.numbered != estimate.numbered) {
    throw InputError(
        fmt::format("{}: has no times, as the other trajectory has; expected --times with a time for each pose",
                    estimate.numbered ? path : arguments.ground_truth));
  }
  const std::size_t poses = estimate.trajectory.size(), expected = ground_truth.trajectory.size();
  if (!estimate.numbered || poses == expected) return;
  throw InputError(fmt::format("{}: has {} poses without times; expected {}, as the ground truth has, or --times", path,
                               poses, expected));
}

/// If the file does not define the unit of its times, takes the one in which they overlap the other trajectory's,
/// `from` to `to`.
void find_unit(PoseFile& file, const std::string& path, double from, double to, const char* option) {
  if (file.unknown_unit.empty()) return;
  const auto unit = unit_that_meets(file.trajectory.start(), file.trajectory.end(), from, to);
  if (!unit) {
    throw InputError(fmt::format("{}; no unit alone makes them meet the other trajectory's, {} to {} s: give {}",
                                 file.unknown_unit, from, to, option));
  }
  set_time_unit(file, *unit);
  fmt::print(stderr, "remark: {}: read with times in {}, in which they meet the other trajectory's\n", path,
             to_string(*unit));
}

void find_units(PoseFile& ground_truth, PoseFile& estimate, const std::string& path, const EvalArguments& arguments) {
  if (!ground_truth.unknown_unit.empty() && !estimate.unknown_unit.empty()) {
    throw InputError(fmt::format("{}; nor is the ground truth's known: give --estimate_unit and --groundtruth_unit",
                                 estimate.unknown_unit));
  }
  const PoseTrajectory &truth = ground_truth.trajectory, &estimated = estimate.trajectory;
  const double offset = arguments.options.time_offset;
  find_unit(estimate, path, truth.start() - offset, truth.end() - offset, "--estimate_unit");
  find_unit(ground_truth, arguments.ground_truth, estimated.start() + offset, estimated.end() + offset,
            "--groundtruth_unit");
}

/// Quaternions read in a wrong order are still rotations: only the ground truth shows the error.
void remark_order(const PoseFile& ground_truth, const PoseFile& estimate, const std::string& path,
                  const EvalArguments& arguments, const Scores& scores) {
  const Similarity undone = scores.alignment.transform.inverse();
  std::vector<PosePair> pairs = scores.compared;
  for (PosePair& pair : pairs) pair.estimate = undone * pair.estimate;
  const auto better =
      better_quaternion_order(pairs, {ground_truth.quaternion, estimate.quaternion, ground_truth.quaternion_is_assumed,
                                      estimate.quaternion_is_assumed});
  if (!better) return;
  const char* const name = kQuaternionOrderNames[index(better->order)];
  fmt::print(stderr,
             "remark: {}: its quaternions seem to be in the order {}: so read, turns of {:.0f} degrees differ from the "
             "other trajectory's by {:.2g} instead of {:.2g} degrees{}; give --{}_quaternion {}\n",
             better->of_ground_truth ? arguments.ground_truth : path, name, better->turn_deg, better->reordered_deg,
             better->as_read_deg, better->frames_differ ? ", but for a rotation between the two bodies' frames" : "",
             better->of_ground_truth ? "groundtruth" : "estimate", name);
}

/// If the ground truth has fewer poses, pairs are made from its poses.
void remark_unmatched(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate, const std::string& path,
                      const EvalArguments& arguments, const Scores& scores) {
  if (scores.unmatched == 0) return;
  const bool truth_leads = !arguments.interpolate && ground_truth.size() < estimate.size();
  fmt::print(
      stderr, "remark: {}: {} of its {} poses are not compared, without ground truth of their own within {} s{}\n",
      path, scores.unmatched, estimate.size(), scores.options.tolerance,
      truth_leads ? "; --interpolate, with a larger --t_max_diff, interpolates the ground truth's fewer poses" : "");
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
  if (arguments.t_start || arguments.t_end) {
    constexpr double kOpen = std::numeric_limits<double>::infinity();
    options.time_range = {arguments.t_start.value_or(-kOpen), arguments.t_end.value_or(kOpen)};
  }
  if (!arguments.protocol.empty()) return options_by_protocol(arguments.protocol, options);
  options.alignment = alignment_name(arguments);
  options.align_first = std::max(arguments.n_to_align, 0);  // 0: all
  options.association = arguments.interpolate ? "interpolated" : "nearest";
  options.rpe_unit = unit_name(arguments.delta_unit);
  options.rpe_pairing = arguments.all_pairs ? "all" : "consecutive";
  options.rpe_pairs_from = arguments.pairs_from_reference ? "ground_truth" : "estimate";
  return options;
}

/// Errors name the estimate's file.
ScoredEstimate score_file(PoseFile ground_truth, const std::string& path, const EvalArguments& arguments) {
  PoseFile estimate = read_file(path, arguments.estimate_unit, arguments.estimate_quaternion, arguments);
  print_remarks(estimate);
  check_numbers(ground_truth, estimate, path, arguments);
  find_units(ground_truth, estimate, path, arguments);
  try {
    ScoreOptions options = score_options(arguments);
    if (arguments.fit_offset) {
      const OffsetFit fit =
          fit_time_offset(ground_truth.trajectory, estimate.trajectory, options, *arguments.fit_offset);
      options.time_offset = fit.offset;
      fmt::print(stderr, "remark: {}: {:.4f} s are added to its times: they make the position error smallest{}\n", path,
                 fit.offset, fit.at_edge ? " within --fit_offset; beyond it may be smaller still" : "");
    }
    Scores scores = score(ground_truth.trajectory, estimate.trajectory, options);
    score_velocities(ground_truth.trajectory, ground_truth.velocities, estimate.trajectory, estimate.velocities,
                     scores);
    remark_order(ground_truth, estimate, path, arguments, scores);
    remark_unmatched(ground_truth.trajectory, estimate.trajectory, path, arguments, scores);
    return {std::move(estimate.trajectory), std::move(scores)};
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", path, error.what()));
  }
}

/// Leaves fields empty that only a run has.
RunRecord record_of(const std::string& ground_truth, const std::string& estimate, const Scores& scores) {
  RunRecord record;
  record.experiment = ground_truth;
  record.label = estimate;
  record.final_scores = to_json(scores);
  return record;
}

/// Of one estimate the text of a run's metrics.json, of several a list of them.
std::string json_text(const std::vector<RunRecord>& records) {
  Json json = Json::array();
  for (const RunRecord& record : records) json.push_back(to_json(record));
  return json_file_text(records.size() == 1 ? json[0] : json);
}

void check(const EvalArguments& arguments) {
  std::vector<std::string> read = arguments.estimates;
  read.insert(read.end(), {arguments.ground_truth, arguments.times});
  check_outputs({arguments.json, arguments.aligned, arguments.errors, arguments.plot}, read, arguments.force);
  if (!arguments.plot.empty()) check_figure_name(arguments.plot);
  if (arguments.estimates.size() > 1 && !(arguments.aligned.empty() && arguments.errors.empty())) {
    throw InputError(
        fmt::format("--aligned and --errors are of one estimate; {} are given", arguments.estimates.size()));
  }
}

void write_outputs(const EvalArguments& arguments, const std::vector<RunRecord>& records, const ScoredEstimate& last) {
  if (!arguments.json.empty()) write_file(arguments.json, json_text(records));
  if (!arguments.aligned.empty()) {
    write_file(arguments.aligned, format_tum(aligned_estimate(last.estimate, last.scores)));
  }
  if (!arguments.errors.empty()) write_file(arguments.errors, errors_csv(last.scores));
}

/// Names of the estimates in a plot: their files' names if these differ, else the paths.
std::vector<std::string> plot_names(const std::vector<RunRecord>& records) {
  std::set<std::string> names;
  std::vector<std::string> files, paths;
  for (const RunRecord& record : records) {
    paths.push_back(record.label);
    files.push_back(std::filesystem::path(record.label).filename().string());
    names.insert(files.back());
  }
  return names.size() == files.size() ? files : paths;
}

void plot_trajectories(const EvalArguments& arguments, const std::vector<RunRecord>& records,
                       std::vector<Scores> scores, bool numbered) {
  ScoredTrajectories scored{plot_names(records), std::move(scores), "", numbered};
  if (!arguments.no_caption) {
    scored.caption = fmt::format("{}. {}.", std::filesystem::path(arguments.ground_truth).filename().string(),
                                 protocol(records.front().final_scores, arguments.ground_truth, {false, false, false}));
  }
  const Figure figure = arguments.plot_kind == "error"      ? error_figure(scored)
                        : arguments.plot_kind == "position" ? position_figure(scored)
                                                            : trajectory_figure(scored);
  const std::string warnings = draw(figure, arguments.plot, "");
  if (!warnings.empty()) fmt::print(stderr, "{}: is drawn, but Python warns:{}\n", arguments.plot, warnings);
}

/// Prints nothing if an output goes to the standard output.
void print_scores(const EvalArguments& arguments, const std::vector<RunRecord>& records, const ScoredEstimate& last) {
  for (const std::string* path : {&arguments.json, &arguments.aligned, &arguments.errors}) {
    if (*path == "/dev/stdout") return;
  }
  if (arguments.estimates.size() == 1 && arguments.table.empty()) {
    fmt::print("ground truth {}\nestimate     {}\n{}", arguments.ground_truth, arguments.estimates[0],
               describe(last.scores));
    return;
  }
  const std::string format = arguments.table.empty() ? "text" : arguments.table;
  fmt::print("{}", make_table(records, {.format = parse_name<TableFormat>(kTableFormatNames, format, "table format"),
                                        .layout = arguments.layout}));
}

void execute(const EvalArguments& arguments) {
  check(arguments);
  const PoseFile ground_truth =
      read_file(arguments.ground_truth, arguments.ground_truth_unit, arguments.ground_truth_quaternion, arguments);
  print_remarks(ground_truth);
  std::vector<RunRecord> records;
  ScoredEstimate last;
  std::vector<Scores> scores;
  std::vector<std::string> failures;
  for (const std::string& path : arguments.estimates) {
    try {
      last = score_file(ground_truth, path, arguments);
      records.push_back(record_of(arguments.ground_truth, path, last.scores));
      if (!arguments.plot.empty()) scores.push_back(last.scores);
    } catch (const InputError& error) {
      failures.emplace_back(error.what());
    }
  }
  if (records.empty()) throw_together(failures);
  write_outputs(arguments, records, last);
  if (!arguments.plot.empty()) plot_trajectories(arguments, records, std::move(scores), ground_truth.numbered);
  print_scores(arguments, records, last);
  throw_together(failures);
}

void add_file_options(CLI::App& command, EvalArguments& arguments) {
  command
      .add_option(
          "--format", arguments.format,
          "Columns of both files: tum (t x y z qx qy qz qw), euroc (t x y z qw qx qy qz), kitti (3x4 matrices), "
          "robotevt (t r11..r33 x y z); auto: by their names or number")
      ->check(one_of(to_strings(kPoseFormatNames)))
      ->capture_default_str();
  command.add_option("--times", arguments.times, "Times, one per line, for trajectories without (KITTI)")
      ->type_name("FILE");
  const auto add_unit = [&](const char* name, std::string& unit, const std::string& whose) {
    command.add_option(name, unit, "Unit of the " + whose + "'s times; auto: by the name of their column, or seconds")
        ->check(one_of(to_strings(kTimeUnitNames)))
        ->capture_default_str();
  };
  add_unit("--groundtruth_unit", arguments.ground_truth_unit, "ground truth");
  add_unit("--estimate_unit", arguments.estimate_unit, "estimate");
  const auto add_order = [&](const char* name, std::string& order, const std::string& whose) {
    command
        .add_option(name, order, "Order of the " + whose + "'s quaternion columns; auto: by their names or the format")
        ->check(one_of(to_strings(kQuaternionOrderNames)))
        ->capture_default_str();
  };
  add_order("--groundtruth_quaternion", arguments.ground_truth_quaternion, "ground truth");
  add_order("--estimate_quaternion", arguments.estimate_quaternion, "estimate");
  command.add_flag("--velocities", arguments.velocities,
                   "Both files have linear velocities after the pose (t x y z qx qy qz qw vx vy vz), as those of the "
                   "EvSLAM benchmark: they are scored; otherwise velocities are differentiated");
}

/// After all options of protocols: none of them can be given beside a protocol's name.
void add_protocol_option(CLI::App& command, EvalArguments& arguments) {
  auto* protocol = add_protocol_name(command, arguments.protocol,
                                     "Score by a published protocol (evbench list protocols) instead of options for "
                                     "alignment, association, relative errors and segments");
  for (const char* name :
       {"--align", "--correct_scale", "--align_origin", "--alignment", "--n_to_align", "--align_range", "--t_max_diff",
        "--interpolate", "--delta", "--delta_unit", "--delta_tol", "--all_pairs", "--pairs_from_reference",
        "--segments", "--segment_lengths", "--segment_unit"}) {
    protocol->excludes(name);
  }
}

void add_alignment_options(CLI::App& command, EvalArguments& arguments) {
  auto* align = command.add_flag("-a,--align", arguments.align, "SE(3) alignment (Umeyama); with -s: Sim(3)");
  auto* scale =
      command.add_flag("-s,--correct_scale", arguments.correct_scale, "Correct the scale; without -a: only the scale");
  auto* origin = command.add_flag("--align_origin", arguments.align_origin, "Make the first poses equal");
  origin->excludes(align)->excludes(scale);
  command.add_option("--alignment", arguments.alignment, "Alignment by name; also yaw only (about z)")
      ->check(one_of(to_strings(kAlignmentNames)))
      ->excludes(align)
      ->excludes(scale)
      ->excludes(origin);
  auto* first = command.add_option("--n_to_align", arguments.n_to_align, "Align on this many first poses; -1: all")
                    ->check([](const std::string& text) {
                      return text.find_first_not_of("+-0") == std::string::npos
                                 ? fmt::format("{}: expected at least 1, or -1 for all poses", text)
                                 : std::string();
                    })
                    ->check(CLI::Range(-1, std::numeric_limits<int>::max()));
  command.add_option("--align_range", arguments.options.align_range, "Align on the poses between two times [s]")
      ->expected(2)
      ->check(finite_number())
      ->type_name("FROM TO")
      ->excludes(first);
}

void add_association_options(CLI::App& command, EvalArguments& arguments) {
  ScoreOptions& options = arguments.options;
  command.add_option("--t_max_diff", options.tolerance, "Ground truth at most this far in time from a pose [s]")
      ->check(not_negative())
      ->capture_default_str();
  command.add_option("--t_offset", options.time_offset, "Added to the estimate's times [s]")
      ->check(finite_number())
      ->capture_default_str();
  command
      .add_option("--fit_offset", arguments.fit_offset,
                  "Choose the offset, at most this far from --t_offset, that makes the position error smallest [s]")
      ->check(above_zero());
  command.add_option("--t_start", arguments.t_start, "Use ground truth from this time on [s]")->check(finite_number());
  command.add_option("--t_end", arguments.t_end, "Use ground truth up to this time [s]")->check(finite_number());
  command.add_flag("--interpolate", arguments.interpolate, "Interpolate the ground truth at the estimate's times");
}

void add_relative_options(CLI::App& command, EvalArguments& arguments) {
  ScoreOptions& options = arguments.options;
  command.add_option("-d,--delta", options.rpe_delta, "Distance of the two poses of a relative error")
      ->check(above_zero())
      ->capture_default_str();
  command.add_option("-u,--delta_unit", arguments.delta_unit, "Unit of delta: frames, seconds, metres, degrees")
      ->check(one_of({"f", "s", "m", "d"}))
      ->capture_default_str();
  command.add_option("-t,--delta_tol", options.rpe_tolerance, "How far from delta a pair may be, relative to it")
      ->check(not_negative())
      ->capture_default_str();
  command.add_flag("--all_pairs", arguments.all_pairs, "Pairs from every pose, not one chain");
  command.add_flag("--pairs_from_reference", arguments.pairs_from_reference,
                   "Measure metres and degrees on the ground truth, not on the estimate");
}

void add_segment_options(CLI::App& command, EvalArguments& arguments) {
  ScoreOptions& options = arguments.options;
  auto* rule =
      command
          .add_option("--segments", options.segments,
                      "Also errors over sub-trajectories in % and deg/m, as rpg_trajectory_evaluation (rpg) or "
                      "the KITTI odometry benchmark (kitti) define them")
          ->check(one_of(to_strings(kSegmentRuleNames)))
          ->capture_default_str();
  command
      .add_option("--segment_lengths", options.segment_lengths,
                  "Their lengths; by default 10 to 50 % of the path (rpg), 100 to 800 m (kitti)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(above_zero())
      ->type_name("LENGTH,...")
      ->needs(rule);
  command.add_option("--segment_unit", options.segment_unit, "Unit of --segment_lengths")
      ->check(one_of(to_strings(kLengthUnitNames)))
      ->capture_default_str();
}

void add_output_options(CLI::App& command, EvalArguments& arguments) {
  command.add_option("--table", arguments.table, "Print a table of this format; by default text for several estimates")
      ->check(one_of(to_strings(kTableFormatNames)));
  add_wide(command, arguments.layout, arguments.wide);
  command
      .add_option("--json", arguments.json,
                  "Write the scores, with the structure of a run's metrics.json; for several estimates a list of them")
      ->type_name("FILE");
  command.add_option("--aligned", arguments.aligned, "Write the estimate as it is compared, aligned (TUM)")
      ->type_name("FILE");
  command.add_option("--errors", arguments.errors, "Write the error of each pose: CSV")->type_name("FILE");
  command
      .add_option("--plot", arguments.plot,
                  "Draw the aligned estimates and the ground truth to this .svg, .pdf or .png, with matplotlib")
      ->type_name("FILE");
  command
      .add_option("--plot_kind", arguments.plot_kind,
                  "What is drawn: trajectory (from three sides), position (x, y, z over time), error (over time)")
      ->check(one_of({"trajectory", "position", "error"}))
      ->capture_default_str();
  command.add_flag("--no-caption", arguments.no_caption, "Draw no caption below the plot");
  command.add_flag("--force", arguments.force, "Replace files that exist");
}

}  // namespace

void add_eval(CLI::App& app) {
  auto arguments = std::make_shared<EvalArguments>();
  CLI::App* command = app.add_subcommand("eval", "Score trajectories: ATE and RPE, with evo's options and numbers");
  command->add_option("groundtruth", arguments->ground_truth, "Ground truth")->required();
  command->add_option("estimates", arguments->estimates, "Estimated trajectories")->required();
  add_file_options(*command, *arguments);
  add_alignment_options(*command, *arguments);
  add_association_options(*command, *arguments);
  add_relative_options(*command, *arguments);
  add_segment_options(*command, *arguments);
  add_protocol_option(*command, *arguments);
  add_output_options(*command, *arguments);
  command->footer("As evo does, nothing is aligned unless asked for: monocular estimates need -as.");
  command->callback([arguments] { execute(*arguments); });
}

}  // namespace evbench
