#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>

#include "bench/commands/causal_flag.hpp"
#include "bench/commands/commands.hpp"
#include "bench/commands/name_check.hpp"
#include "bench/experiment.hpp"
#include "bench/plugins.hpp"
#include "bench/run_folder.hpp"
#include "core/data/calib.hpp"
#include "core/data/times_file.hpp"
#include "core/data/tracks.hpp"
#include "core/data/tum.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "eval/error_files.hpp"
#include "eval/evo_result.hpp"
#include "eval/pose_samples.hpp"
#include "eval/rpg_layout.hpp"
#include "eval/score_run.hpp"

namespace evbench {
namespace {

struct ExportArguments {
  std::string from;
  std::vector<std::string> overrides;
  std::string ground_truth, tracks, calibration, aligned, errors, evo, rpg;
  std::string at, out;
  bool velocity = false;
  std::string evo_error = kEvoErrorNames[0];
  bool causal = false;
  bool force = false;

  std::vector<std::string> outputs() const {
    return {ground_truth, tracks, calibration, aligned, errors, evo, rpg, out};
  }
  bool of_source() const { return !ground_truth.empty() || !tracks.empty() || !calibration.empty(); }
  bool of_scores() const { return !aligned.empty() || !errors.empty() || !evo.empty() || !rpg.empty(); }
  bool of_run() const { return of_scores() || !at.empty(); }
};

void check(const ExportArguments& arguments) {
  if (!arguments.of_source() && !arguments.of_run()) {
    throw InputError(
        "nothing to export; expected at least one of --groundtruth, --tracks, --calib, --aligned, --errors, --evo, "
        "--rpg, --at");
  }
  if (!arguments.evo.empty() && std::filesystem::path(arguments.evo).extension() != ".zip") {
    throw InputError(
        fmt::format("--evo {}: expected a name that ends with .zip: evo_res reads no other", arguments.evo));
  }
  std::error_code ignored;
  const bool folder = std::filesystem::is_directory(arguments.from, ignored);
  if (arguments.of_run() && !folder) {
    throw InputError(fmt::format("{}: --aligned, --errors, --evo, --rpg and --at are of a run; expected its folder",
                                 arguments.from));
  }
  if (folder && !std::filesystem::exists(arguments.from + "/metrics.json")) {
    throw InputError(fmt::format("{}: has no metrics.json; expected the folder of a run", arguments.from));
  }
  std::vector<std::string> read = {arguments.from, arguments.at};
  for (const char* name : {"config.json", "job.json", "manifest.json", "metrics.json", "status.json", "final.tum",
                           "causal.tum", "groundtruth.tum", "map.ply", "timing.csv", "log.txt"}) {
    read.push_back(arguments.from + "/" + name);
  }
  check_outputs(arguments.outputs(), read, arguments.force);
  if (folder && !arguments.overrides.empty()) {
    throw InputError(fmt::format("{}: --set changes configs, not finished runs", arguments.from));
  }
}

/// Loads no library that only the config names; if its source needs one, the error says so.
std::unique_ptr<Source> make_source_of(const std::string& config, const ExportArguments& arguments,
                                       const Plugins& plugins) {
  try {
    return read_source(config, plugins, arguments.overrides);
  } catch (const InputError& error) {
    const std::string missing = missing_libraries(plugins, config, arguments.overrides);
    if (missing.empty()) throw;
    throw InputError(fmt::format("{}; {}", error.what(), missing));
  }
}

void export_source(const std::string& config, const ExportArguments& arguments, const Plugins& plugins) {
  const std::unique_ptr<Source> source = make_source_of(config, arguments, plugins);
  std::vector<std::string> read = source->files();
  std::ranges::move(source->event_files(), std::back_inserter(read));
  check_outputs(arguments.outputs(), read, true);  // existing files were checked before any were written
  const auto tracks = source->true_tracks();
  if (!arguments.ground_truth.empty() && source->ground_truth().empty()) {
    throw InputError(fmt::format("{}: its source has no ground truth", config));
  }
  if (!arguments.tracks.empty() && !tracks) {
    throw InputError(fmt::format("{}: its source knows no tracks; expected a simulated one", config));
  }
  if (!arguments.ground_truth.empty()) write_file(arguments.ground_truth, format_tum(source->ground_truth()));
  if (!arguments.tracks.empty()) write_file(arguments.tracks, format_tracks(*tracks));
  if (!arguments.calibration.empty()) write_file(arguments.calibration, format_calib(source->camera()));
}

void export_run(const ExportArguments& arguments) {
  const ScoreOptions protocol = protocol_of_run(arguments.from);
  const RunRecord record = read_record(arguments.from);
  const auto [estimate, scores] = score_estimate(arguments.from, arguments.causal, protocol, record);
  if (!arguments.aligned.empty()) write_file(arguments.aligned, format_tum(aligned_estimate(estimate, scores)));
  if (!arguments.errors.empty()) write_file(arguments.errors, errors_csv(scores));
  if (!arguments.evo.empty()) {
    const auto error = parse_name<EvoError>(kEvoErrorNames, arguments.evo_error, "error");
    write_file(arguments.evo, evo_result(scores, error, record.label));
  }
  if (arguments.rpg.empty()) return;
  AtomicFolder folder(arguments.rpg);
  for (const auto& [name, text] : rpg_layout(read_tum(arguments.from + "/groundtruth.tum"), estimate, protocol)) {
    folder.write(name, text);
  }
  folder.commit();
}

/// Aligned as the run was scored, if it has ground truth.
void export_samples(const ExportArguments& arguments) {
  const RunEstimate estimate = read_run_estimate(arguments.from, {.causal = arguments.causal});
  if (estimate.poses.empty()) throw InputError(fmt::format("{}: the run has no trajectory", arguments.from));
  Similarity alignment;
  double offset = 0.0;
  const bool is_scored = std::filesystem::exists(arguments.from + "/groundtruth.tum");
  if (is_scored) {
    const Scores scores =
        score_estimate(arguments.from, arguments.causal, protocol_of_run(arguments.from), read_record(arguments.from))
            .scores;
    alignment = scores.alignment.transform;
    offset = scores.options.time_offset;
  }
  const std::vector<double> times = read_times(arguments.at);
  const PoseSamples samples = sample_poses(estimate, alignment, offset, times, arguments.velocity);
  if (samples.text.empty()) {
    throw InputError(fmt::format("{}: its times, {} to {} s, are not those of the estimate, {} to {} s", arguments.at,
                                 std::ranges::min(times), std::ranges::max(times), estimate.poses.start() + offset,
                                 estimate.poses.end() + offset));
  }
  if (arguments.out.empty()) {
    fmt::print("{}", samples.text);
  } else {
    write_file(arguments.out, samples.text);
  }
  fmt::print(stderr, "remark: {}{}\n",
             is_scored ? "aligned as the run was scored" : "no ground truth: in the back-end's own world and scale",
             !arguments.velocity    ? ""
             : samples.own_velocity ? "; velocities as the back-end states them"
                                    : "; velocities by differentiation of the poses");
  if (samples.left_out > 0) {
    fmt::print(stderr, "remark: {} of {} times are left out: the estimate does not cover them\n", samples.left_out,
               times.size());
  }
}

void execute(const ExportArguments& arguments, const Plugins& plugins) {
  check(arguments);
  const bool folder = std::filesystem::is_directory(arguments.from);
  if (arguments.of_scores()) export_run(arguments);
  if (!arguments.at.empty()) export_samples(arguments);
  if (arguments.of_source()) {
    export_source(folder ? arguments.from + "/config.json" : arguments.from, arguments, plugins);
  }
  for (const std::string& output : arguments.outputs()) {
    if (!output.empty()) fmt::print(stderr, "written: {}\n", output);  // a file may be the standard output
  }
}

}  // namespace

void add_export(CLI::App& app, const Plugins& plugins) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command =
      app.add_subcommand("export", "Write a sequence's ground truth and tracks, a run's aligned estimate and errors");
  command->add_option("from", arguments->from, "Config, or folder of a run")->required()->type_name("FROM");
  command->add_option("--groundtruth", arguments->ground_truth, "All of the source's ground truth (TUM)")
      ->type_name("FILE");
  command->add_option("--tracks", arguments->tracks, "The tracks of a simulated source: id t x y, raw pixels")
      ->type_name("FILE");
  command->add_option("--calib", arguments->calibration, "The source's camera: fx fy cx cy k1 k2 p1 p2 k3")
      ->type_name("FILE");
  command->add_option("--aligned", arguments->aligned, "The run's estimate, aligned as it was scored (TUM)")
      ->type_name("FILE");
  command->add_option("--errors", arguments->errors, "The error of each of its poses: CSV")->type_name("FILE");
  command->add_option("--evo", arguments->evo, "Its errors as evo's result archive, for evo_res")
      ->type_name("FILE.zip");
  command
      ->add_option("--evo-error", arguments->evo_error,
                   "Errors to export: absolute or relative, translation or rotation")
      ->check(one_of(to_strings(kEvoErrorNames)))
      ->capture_default_str();
  command
      ->add_option("--rpg", arguments->rpg,
                   "A folder for rpg_trajectory_evaluation: the estimate, the ground truth, the alignment")
      ->type_name("DIR");
  auto* at = command
                 ->add_option("--at", arguments->at,
                              "Its poses at the times in this file, one a line [s]: t x y z qx qy qz qw, aligned if it "
                              "has ground truth")
                 ->type_name("TIMES");
  command
      ->add_flag(
          "--velocity", arguments->velocity,
          "With --at: also the linear velocity in the camera's frame, vx vy vz, as the EvSLAM benchmark takes it")
      ->needs(at);
  command->add_option("--out", arguments->out, "File for --at; by default the standard output")
      ->type_name("FILE")
      ->needs(at);
  add_causal_flag(*command, arguments->causal, "The causal poses, as first published, not the final ones");
  add_overrides(*command, arguments->overrides, "Override a value of the config: KEY=VALUE, e.g. seed=3");
  command->add_flag("--force", arguments->force, "Replace files that exist");
  command->footer(
      "A config's source is made as by evbench run: the same seed gives the same tracks. Exported as groundtruth.txt,\n"
      "calib.txt and tracks.txt, it can be run with the source recording and the front-end recorded. The folder of a\n"
      "run can be given instead of its config; its estimate is scored by its own protocol.");
  command->callback([arguments, &plugins] { execute(*arguments, plugins); });
}

}  // namespace evbench
