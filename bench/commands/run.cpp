#include "bench/commands/run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/commands/commands.hpp"
#include "bench/commands/exit_code.hpp"
#include "bench/commands/progress_line.hpp"
#include "bench/commands/report.hpp"
#include "bench/commands/run_outputs.hpp"
#include "bench/commands/run_selection.hpp"
#include "bench/plugins.hpp"
#include "bench/run_folder.hpp"
#include "bench/run_index.hpp"
#include "bench/runner.hpp"
#include "bench/scores_by_protocol.hpp"
#include "bench/sweep/local_executor.hpp"
#include "bench/sweep/process_pool.hpp"
#include "bench/sweep/shared_events.hpp"
#include "core/support/interruption.hpp"
#include "eval/table.hpp"

namespace evbench {
namespace {

/// Plans all runs in the config's order. Two runs with the same job are a mistake in the config.
std::vector<PlannedRun> plan(const Experiment& experiment, const Source& source, const Plugins& plugins,
                             const RunArguments& arguments) {
  Digests digests;
  std::vector<PlannedRun> planned;
  for (const RunConfig& config : experiment.runs) {
    JobIdentity identity = identify(config.job, source, plugins, digests);
    for (const PlannedRun& other : planned) {
      if (other.identity.key != identity.key) continue;
      throw InputError(fmt::format("{}: the back-ends \"{}\" and \"{}\" are the same: type and options are equal",
                                   arguments.config, other.config.label, config.label));
    }
    planned.push_back({config, std::move(identity), {}, "", "", {}});
  }
  if (arguments.jobs > 1) {
    share_what_is_made_of_events(planned, plugins, [&](const Job&) { return !source.event_files().empty(); });
  }
  return planned;
}

ExecutorOptions executor_options(const RunArguments& arguments) {
  ExecutorOptions options;
  options.out = arguments.out;
  options.processes = arguments.jobs;
  options.retry_failed = true;
  options.force = arguments.force;
  options.outputs = {arguments.problem, arguments.tracks};
  return options;
}

/// The runs of an experiment. Complete ones are reused; the others are done, one after the other in this process or
/// several at a time in processes of their own.
class Runs {
 public:
  Runs(const RunArguments& arguments, const Plugins& plugins, const Experiment& experiment, const Source& source)
      : arguments_(arguments),
        plugins_(plugins),
        source_(source),
        runs_(plan(experiment, source, plugins, arguments)),
        ground_truth_(ground_truth_tum(source)),
        index_(arguments.out + "/" + experiment.name) {}

  void print_complete() const {
    if (runs_.front().config.job.pipeline.mode == "free" && !arguments_.quiet) {
      fmt::print("pipeline.mode is free: not reproducible, results differ from run to run\n");
    }
    const auto complete =
        std::ranges::count_if(runs_, [&](const PlannedRun& run) { return complete_run(run).has_value(); });
    if (complete == 0 || arguments_.quiet) return;
    fmt::print("complete already: {} of {} (--force does them again)\n", complete, runs_.size());
    std::fflush(stdout);
  }

  void run_all() {
    if (arguments_.jobs > 1) {
      run_in_processes();
      return;
    }
    for (const PlannedRun& run : runs_) {
      check_interruption();
      const auto complete = complete_run(run);
      records_.push_back(complete ? adopt_run(*complete, folder_of(run), run.config) : do_run(run));
      index_.add();
    }
    index_.write();
  }

  const std::vector<RunRecord>& records() const { return records_; }
  std::size_t size() const { return runs_.size(); }

 private:
  std::string folder_of(const PlannedRun& run) const {
    return fmt::format("{}/{}/{}", arguments_.out, run.config.experiment, run.identity.key);
  }

  std::optional<std::string> complete_run(const PlannedRun& run) const {
    if (arguments_.force) return std::nullopt;
    auto folder = find_complete_run(arguments_.out, run.config.experiment, run.identity);
    const RunOutputs wanted{arguments_.problem, arguments_.tracks};
    return folder && wanted.are_in(*folder) ? folder : std::nullopt;
  }

  /// The records are in the config's order, whichever run ends first.
  void run_in_processes() {
    ProgressLine line(arguments_.config, arguments_.quiet, arguments_.watch);
    const auto report = [&](const SweepProgress& now) { line.update(describe(now)); };
    const auto read = [&] {
      for (const PlannedRun& run : runs_) {
        std::string ignored;
        const RunCondition condition = condition_of(folder_of(run), run.identity.key, ignored);
        if (condition == RunCondition::absent || condition == RunCondition::damaged) continue;
        records_.push_back(read_record(folder_of(run)));
      }
    };
    try {
      do_runs(runs_, plugins_, executor_options(arguments_), report);
    } catch (const InputError&) {
      read();
      throw;
    }
    read();
  }

  RunRecord do_run(const PlannedRun& run) const {
    RunFolder folder(arguments_.out, run.config.experiment, run.identity.key);
    ProgressLine line(fmt::format("[{}/{}] {}", records_.size() + 1, runs_.size(), run.config.label), arguments_.quiet,
                      arguments_.watch);
    const auto report = [&](const RunProgress& now) {
      std::string text =
          fmt::format("{:.2f} of {:.2f} s, {} tracks, {} landmarks, {} states, delay {:.0f} ms",
                      std::min(now.t, now.end), now.end, now.tracks, now.landmarks, now.states, 1e3 * now.delay);
      if (now.realtime_factor) text += fmt::format(", real-time factor {:.2f}", *now.realtime_factor);
      line.update(text);
    };
    const Execution execution = execute(run.config.job, source_, plugins_, report, arguments_.tracks);
    return folder.write(run.config, run.identity, source_, ground_truth_, execution, arguments_.problem);
  }

  const RunArguments& arguments_;
  const Plugins& plugins_;
  const Source& source_;
  std::vector<PlannedRun> runs_;
  std::string ground_truth_;
  std::vector<RunRecord> records_;
  RunIndex index_;
};

/// Events that several runs need and that are in no file: they are simulated once.
class KeptEvents {
 public:
  explicit KeptEvents(const std::string& folder) : path_(fmt::format("{}/.events-{}.evb", folder, ::getpid())) {}
  ~KeptEvents() {
    std::error_code error;
    std::filesystem::remove(path_, error);
  }
  KeptEvents(const KeptEvents&) = delete;
  KeptEvents& operator=(const KeptEvents&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

bool makes_events_repeatedly(const Experiment& experiment, const Source& source, const Plugins& plugins) {
  const PluginConfig& frontend = experiment.runs.front().job.frontend;
  return experiment.runs.size() > 1 && source.event_files().empty() &&
         plugins.of<FrontEnd>().find(frontend.type, frontend.place + ".type").reads_events;
}

void print_table(const Runs& runs, const RunArguments& arguments, const std::string& experiment) {
  if (arguments.quiet || runs.records().empty()) return;
  std::vector<RunRecord> records = runs.records();
  score_common_time(records, false);
  fmt::print("{}", make_table(records, {.layout = {.width = text_width()}}));
  fmt::print("\nwritten: {}\n", (std::filesystem::path(arguments.out) / experiment).string());
  std::fflush(stdout);
}

/// Throws OutputError unless results can be written to the folder, or the folder can be made.
void check_writable(const std::string& folder) {
  std::error_code error;
  std::filesystem::path place = std::filesystem::absolute(folder);
  for (const std::filesystem::path& name : place) {
    if (name.native().size() > NAME_MAX || place.native().size() > PATH_MAX) {
      throw OutputError(
          fmt::format("{:.80}...: is too long for a folder; expected names of at most {} characters, {} in all",
                      name.string(), NAME_MAX, PATH_MAX));
    }
  }
  while (!std::filesystem::exists(place, error) && place.has_relative_path()) place = place.parent_path();
  if (!std::filesystem::is_directory(place, error)) {
    throw OutputError(fmt::format("{}: is no folder; expected one for results", place.string()));
  }
  if (::access(place.c_str(), W_OK) != 0) {
    throw OutputError(fmt::format("{}: can't be written to: {}", place.string(), std::strerror(errno)));
  }
}

/// Checks a config without starting commands or loading libraries that only the config names.
void check(const RunArguments& arguments, const Plugins& plugins) {
  check_writable(arguments.out);
  std::vector<std::string> unchecked;
  const std::string missing = missing_libraries(plugins, arguments.config, arguments.overrides);
  const std::vector<std::string> unknown =
      missing.empty() ? std::vector<std::string>() : unknown_plugins(arguments.config, arguments.overrides, plugins);
  if (!unknown.empty()) {
    const bool source_known = !unknown.front().starts_with("source");
    if (source_known) read_source(arguments.config, plugins, arguments.overrides);
    fmt::print("{}: {}; not checked: {} ({})\n", arguments.config, source_known ? "its source is fine" : "it is JSON",
               fmt::join(unknown, ", "), missing);
    return;
  }
  const Experiment experiment = read_experiment(arguments.config, arguments.overrides, plugins);
  check_writable(arguments.out + "/" + experiment.name);
  const std::unique_ptr<Source> source = make_source(experiment.runs.front().job, plugins);
  for (const RunConfig& config : experiment.runs) {
    for (std::string& text : check_job(config.job, *source, plugins)) {
      if (std::ranges::find(unchecked, text) == unchecked.end()) unchecked.push_back(std::move(text));
    }
  }
  for (const std::string& remark : experiment.remarks) fmt::print("{}\n", remark);
  fmt::print("{}: fine, {} run{}\n", arguments.config, experiment.runs.size(), experiment.runs.size() == 1 ? "" : "s");
  if (!missing.empty()) unchecked.push_back(missing);
  for (const std::string& text : unchecked) fmt::print("not checked: {}\n", text);
}

}  // namespace

int run_config(const RunArguments& arguments, Plugins& plugins, std::vector<RunRecord>* records) {
  const Interruption interruption(arguments.config + ": interrupted; no run was started");
  if (arguments.jobs > 1) stay_without_threads();
  if (arguments.check) {
    check(arguments, plugins);
    return kExitDone;
  }
  const Announce announce = announcement(arguments.quiet);
  load_plugins_of(plugins, arguments.config, arguments.overrides, {.announce = announce});
  const Experiment experiment = read_experiment(arguments.config, arguments.overrides, plugins);
  for (const std::string& remark : experiment.remarks) announce(fmt::format("{}: {}", arguments.config, remark));
  if (arguments.report) check_report_of((std::filesystem::path(arguments.out) / experiment.name).string());
  std::vector<const Job*> jobs;
  for (const RunConfig& run : experiment.runs) jobs.push_back(&run.job);
  announce_commands(jobs, plugins, announce);
  std::unique_ptr<Source> source = make_source(experiment.runs.front().job, plugins);
  const KeptEvents kept(arguments.out);
  if (makes_events_repeatedly(experiment, *source, plugins) && arguments.jobs == 1) {
    source = with_kept_events(std::move(source), kept.path());
  }
  Runs runs(arguments, plugins, experiment, *source);
  runs.print_complete();
  try {
    runs.run_all();
  } catch (const Interrupted& interrupted) {
    print_table(runs, arguments, experiment.name);
    throw Interrupted(fmt::format("{}: interrupted; {} of {} runs are complete, the same command continues from there",
                                  arguments.config, runs.records().size(), runs.size()),
                      interrupted.signal());
  } catch (const OutputError&) {
    print_table(runs, arguments, experiment.name);
    throw;
  }
  print_table(runs, arguments, experiment.name);
  if (arguments.report) {
    report_folder((std::filesystem::path(arguments.out) / experiment.name).string(), "evbench run " + arguments.config,
                  arguments.quiet);
  }
  if (records != nullptr) records->insert(records->end(), runs.records().begin(), runs.records().end());
  const bool failed = std::ranges::any_of(
      runs.records(), [](const RunRecord& run) { return run.status && run.status->status.state == RunState::failed; });
  return failed ? kExitFailed : kExitDone;
}

std::function<void(const std::string&)> announcement(bool quiet) {
  return [quiet](const std::string& sentence) {
    if (quiet) return;
    fmt::print("{}\n", sentence);
    std::fflush(stdout);
  };
}

void add_overrides(CLI::App& command, std::vector<std::string>& overrides, const std::string& text) {
  command.add_option("--set", overrides, text)
      ->type_name("KEY=VALUE")
      ->check(has_equals("KEY=VALUE"))
      ->allow_extra_args(false);  // so that the config may follow
}

void add_run(CLI::App& app, Plugins& plugins, int& exit_code) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "Run a config: one back-end, or a comparison of several");
  command->add_option("config", arguments->config, "JSON config")->required();
  add_overrides(*command, arguments->overrides, "Override a value: KEY=VALUE, e.g. backend.placement.rate=50");
  command->add_option("--out", arguments->out, "Folder for results")->capture_default_str();
  command
      ->add_option(
          "-j,--jobs", arguments->jobs,
          "Runs at a time, for a config with several back-ends, each in a process of its own; use 1 to compare "
          "times")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  command->add_flag("--force", arguments->force, "Repeat runs that are complete already");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  command->add_flag("--problem", arguments->problem,
                    "Also write problem.txt: the final problem of gp_map, for evbench solve and other solvers");
  command->add_flag(
      "--tracks", arguments->tracks,
      "Also write tracks.txt and track_ends.txt: the tracks of the front-end, for evbench render and the front-end "
      "recorded");
  command->add_flag("--report", arguments->report,
                    "Also write OUT/EXPERIMENT/report.html: a page of all runs there (evbench report)");
  command->add_flag("--watch", arguments->watch,
                    "Print a line each second, on the standard error: time, tracks, landmarks, states, delay, "
                    "real-time factor");
  command->add_flag(
      "--check", arguments->check,
      "Only check the config, and that its files can be read; starts no command and loads no library that only the "
      "config names, and lists what is therefore not checked");
  command->footer(
      "Each run writes OUT/EXPERIMENT/KEY: config.json, job.json, manifest.json, final.tum, causal.tum,\n"
      "causal_poses.txt, groundtruth.tum, map.ply, metrics.json, timing.csv, log.txt, status.json. KEY is a hash\n"
      "of all that determines the trajectory (job.json). A run that is complete below OUT is not repeated, but\n"
      "labelled and scored as the config says; a run that ended with an error is repeated.\n"
      "Exit codes: 0 done (also when a run is degraded or lost: see its status), 2 bad input, 3 a run failed,\n"
      "4 results can't be written (disk full), 130 interrupted (Ctrl-C).");
  command->callback([arguments, &plugins, &exit_code] { exit_code = run_config(*arguments, plugins); });
}

}  // namespace evbench
