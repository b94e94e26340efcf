#include "bench/commands/run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <climits>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/commands/commands.hpp"
#include "bench/commands/exit_code.hpp"
#include "bench/commands/progress_line.hpp"
#include "bench/common_time.hpp"
#include "bench/plugins.hpp"
#include "bench/run_folder.hpp"
#include "bench/runner.hpp"
#include "core/support/interruption.hpp"
#include "eval/table.hpp"

namespace evbench {
namespace {

/// A run of the config, and what determines its result.
struct PlannedRun {
  RunConfig config;
  JobIdentity identity;
  std::string folder;
};

/// All runs in the config's order. Two that would do the same work are a mistake in the config.
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
    std::string folder = fmt::format("{}/{}/{}", arguments.out, experiment.name, identity.key);
    planned.push_back({config, std::move(identity), std::move(folder)});
  }
  return planned;
}

/// The runs of an experiment one after the other: those that are complete already are taken, the others done.
class Runs {
 public:
  Runs(const RunArguments& arguments, const Plugins& plugins, const Experiment& experiment, const Source& source)
      : arguments_(arguments),
        plugins_(plugins),
        source_(source),
        runs_(plan(experiment, source, plugins, arguments)),
        ground_truth_(ground_truth_tum(source)) {}

  void tell_complete() const {
    if (runs_.front().config.job.pipeline.mode == "free" && !arguments_.quiet) {
      fmt::print("pipeline.mode is free: not reproducible, the same config gives other results each time\n");
    }
    const auto complete =
        std::ranges::count_if(runs_, [&](const PlannedRun& run) { return complete_run(run).has_value(); });
    if (complete == 0 || arguments_.quiet) return;
    fmt::print("complete already: {} of {} (--force does them again)\n", complete, runs_.size());
    std::fflush(stdout);
  }

  void run_all() {
    for (const PlannedRun& run : runs_) {
      check_interruption();
      const auto complete = complete_run(run);
      records_.push_back(complete ? adopt_run(*complete, run.folder, run.config) : do_run(run));
    }
  }

  const std::vector<RunRecord>& records() const { return records_; }
  std::size_t size() const { return runs_.size(); }

 private:
  std::optional<std::string> complete_run(const PlannedRun& run) const {
    if (arguments_.force) return std::nullopt;
    auto folder = find_complete_run(arguments_.out, run.config.experiment, run.identity);
    const auto lacks = [&](bool wanted, const char* file) {
      return wanted && folder && !std::filesystem::exists(*folder + file);
    };
    if (lacks(arguments_.problem, "/problem.txt") || lacks(arguments_.tracks, "/track_ends.txt")) return std::nullopt;
    return folder;
  }

  RunRecord do_run(const PlannedRun& run) const {
    RunFolder folder(arguments_.out, run.config.experiment, run.identity.key);
    ProgressLine line(fmt::format("[{}/{}] {}", records_.size() + 1, runs_.size(), run.config.label), arguments_.quiet,
                      arguments_.watch);
    const auto start = std::chrono::steady_clock::now();
    const auto tell = [&](const RunProgress& now) {
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      const double pace = (now.t - source_.time_range().from) / std::max(seconds, 1e-9);
      line.update(
          fmt::format("{:.2f} of {:.2f} s, {} tracks, {} landmarks, {} states, delay {:.0f} ms, {:.2f} x real time",
                      std::min(now.t, now.end), now.end, now.tracks, now.landmarks, now.states, 1e3 * now.delay, pace));
    };
    const Execution execution = execute(run.config.job, source_, plugins_, tell, arguments_.tracks);
    return folder.write(run.config, run.identity, source_, ground_truth_, execution, arguments_.problem);
  }

  const RunArguments& arguments_;
  const Plugins& plugins_;
  const Source& source_;
  std::vector<PlannedRun> runs_;
  std::string ground_truth_;
  std::vector<RunRecord> records_;
};

void print_table(const Runs& runs, const RunArguments& arguments, const std::string& experiment) {
  if (arguments.quiet || runs.records().empty()) return;
  std::vector<RunRecord> records = runs.records();
  score_common_time(records, false);
  fmt::print("{}", make_table(records, {}));
  fmt::print("\nwritten: {}\n", (std::filesystem::path(arguments.out) / experiment).string());
  std::fflush(stdout);
}

/// Results can be written to a folder, or to one that is to be made there.
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

void check(const RunArguments& arguments, const Experiment& experiment, const Plugins& plugins) {
  check_writable(arguments.out + "/" + experiment.name);
  const std::unique_ptr<Source> source = make_source(experiment.runs.front().job, plugins);
  for (const RunConfig& config : experiment.runs) check_job(config.job, *source, plugins);
  fmt::print("{}: fine, {} run{}\n", arguments.config, experiment.runs.size(), experiment.runs.size() == 1 ? "" : "s");
}

}  // namespace

int run_config(const RunArguments& arguments, Plugins& plugins) {
  const Interruption interruption(arguments.config + ": interrupted; no run was begun");
  load_plugins_of(plugins, arguments.config, arguments.overrides);
  const Experiment experiment = read_experiment(arguments.config, arguments.overrides, plugins);
  if (arguments.check) {
    check(arguments, experiment, plugins);
    return kExitDone;
  }
  const std::unique_ptr<Source> source = make_source(experiment.runs.front().job, plugins);
  Runs runs(arguments, plugins, experiment, *source);
  runs.tell_complete();
  try {
    runs.run_all();
  } catch (const Interrupted& interrupted) {
    print_table(runs, arguments, experiment.name);
    throw Interrupted(fmt::format("{}: interrupted; {} of {} runs are complete, the same command goes on from there",
                                  arguments.config, runs.records().size(), runs.size()),
                      interrupted.signal());
  } catch (const OutputError&) {
    print_table(runs, arguments, experiment.name);
    throw;
  }
  print_table(runs, arguments, experiment.name);
  const bool failed = std::ranges::any_of(
      runs.records(), [](const RunRecord& run) { return run.status && run.status->status.state == RunState::failed; });
  return failed ? kExitFailed : kExitDone;
}

void add_overrides(CLI::App& command, std::vector<std::string>& overrides, const std::string& text) {
  command.add_option("--set", overrides, text)
      ->type_name("KEY=VALUE")
      ->check([](const std::string& value) {
        return value.find('=') == std::string::npos ? fmt::format("{}: expected KEY=VALUE", value) : std::string();
      })
      ->allow_extra_args(false);  // so that the config may stand behind it
}

void add_run(CLI::App& app, Plugins& plugins, int& exit_code) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "Run a config: one back-end, or a comparison on identical tracks");
  command->add_option("config", arguments->config, "JSON config")->required();
  add_overrides(*command, arguments->overrides, "Override a value: KEY=VALUE, e.g. backend.placement.rate=50");
  command->add_option("--out", arguments->out, "Folder for results")->capture_default_str();
  command->add_flag("--force", arguments->force, "Do runs again that are complete already");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  command->add_flag("--problem", arguments->problem,
                    "Also write problem.txt: the problem that gp_map ended with, for evbench solve and other solvers");
  command->add_flag(
      "--tracks", arguments->tracks,
      "Also write tracks.txt and track_ends.txt: what the front-end told, for evbench render and the front-end "
      "recorded");
  command->add_flag("--watch", arguments->watch,
                    "Print a line each second, on the standard error: how far, tracks, landmarks, states, delay, pace");
  command->add_flag("--check", arguments->check, "Check the config, and that its files can be read, and stop");
  command->footer(
      "Each run writes OUT/EXPERIMENT/KEY: config.json, job.json, manifest.json, final.tum, online.tum, told.txt,\n"
      "groundtruth.tum, map.ply, metrics.json, timing.csv, log.txt, status.json. KEY names what determines the\n"
      "trajectory (job.json). A run that is complete below OUT is not done again, but named and scored as the config\n"
      "says; one that broke off with an error is.\n"
      "Exit codes: 0 done (also when a run is degraded or lost: see its status), 2 bad input, 3 a run failed,\n"
      "4 results can't be written (disk full), 130 interrupted (Ctrl-C).");
  command->callback([arguments, &plugins, &exit_code] { exit_code = run_config(*arguments, plugins); });
}

}  // namespace evbench
