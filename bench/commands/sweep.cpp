#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "bench/commands/commands.hpp"
#include "bench/commands/exit_code.hpp"
#include "bench/commands/name_check.hpp"
#include "bench/commands/number_check.hpp"
#include "bench/commands/progress_line.hpp"
#include "bench/commands/report.hpp"
#include "bench/plugins.hpp"
#include "bench/run_folder.hpp"
#include "bench/sweep/local_executor.hpp"
#include "bench/sweep/manifest.hpp"
#include "bench/sweep/process_pool.hpp"
#include "bench/sweep/slurm_executor.hpp"
#include "bench/sweep/sweep_status.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/interruption.hpp"
#include "core/support/json.hpp"

namespace evbench {
namespace {

struct SweepArguments {
  std::string file;
  std::vector<std::string> vary, only, overrides;
  ExecutorOptions options;
  std::optional<double> seconds, memory_mib;
  std::optional<int> at_a_time;
  SlurmOptions slurm;
  std::string executor = "local";
  bool dry_run = false, quiet = false, report = false;
};

void print_plan(const std::vector<PlannedRun>& runs, const SweepPlan& plan, const ExecutorOptions& options) {
  constexpr const char* kConditions[] = {"to do", "complete", "broken off", "damaged"};
  std::set<std::string> all, to_do, failed;  // keys: several runs may have the same job
  for (const PlannedRun& run : runs) {
    std::string why;
    auto condition =
        condition_of(fmt::format("{}/{}/{}", options.out, plan.name, run.identity.key), run.identity.key, why);
    if (condition == RunCondition::absent && find_complete_run(options.out, plan.name, run.identity)) {
      condition = RunCondition::complete;
    }
    all.insert(run.identity.key);
    if (condition == RunCondition::absent) to_do.insert(run.identity.key);
    if (condition == RunCondition::broken_off || condition == RunCondition::damaged) failed.insert(run.identity.key);
    fmt::print("{:<10}  {}  {}{}{}\n", kConditions[static_cast<int>(condition)], run.identity.key, run.config.label,
               run.axes.empty() ? "" : ", ", place_of(run.axes));
  }
  const bool retried = options.retry_failed;
  fmt::print("{} runs, {} to do{}\n", all.size(), to_do.size() + (retried ? failed.size() : 0),
             failed.empty() || retried
                 ? ""
                 : fmt::format(", {} broken off or damaged (--retry-failed does them again)", failed.size()));
}

int do_locally(const std::vector<PlannedRun>& runs, const SweepArguments& arguments, const std::string& folder,
               const Plugins& plugins) {
  ProgressLine line(folder, arguments.quiet);
  SweepProgress now;
  std::size_t reported = 0;
  const auto report = [&](const SweepProgress& progress) {
    for (; reported < progress.troubled.size(); ++reported) {
      line.clear();
      fmt::print(stderr, "{}\n", describe(progress.troubled[reported]));
    }
    line.update(describe(progress));
    now = progress;
  };
  const auto complete = [&] {
    return fmt::format("{} of {} runs are complete, the same command continues from there", now.done, now.runs);
  };
  try {
    now = do_runs(runs, plugins, arguments.options, report);
    report(now);
    line.clear();
  } catch (const Interrupted& interrupted) {
    throw Interrupted(fmt::format("{}: interrupted; {}", folder, complete()), interrupted.signal());
  } catch (const OutputError& error) {
    throw OutputError(fmt::format("{}; {}", error.what(), complete()));
  }
  if (!arguments.quiet) {
    fmt::print("{}: {} runs, {} of them done before, {} failed{}\n", folder, now.runs, now.before, now.failed,
               now.failed == 0 ? "" : " (--retry-failed does again those that broke off or are damaged)");
    const std::size_t others = count_others(folder, read_sweep_record(folder + "/sweep.json"));
    if (others > 0) fmt::print("{}\n", describe_others(others));
    fmt::print("evbench table {}\n", folder);
  }
  return now.failed == 0 ? kExitDone : kExitFailed;
}

/// With --wait the exit code is that of the finished sweep.
int exit_code_of(const std::string& folder) {
  for (const SweepStatus& sweep : read_sweep_status(folder)) {
    if (sweep.done < sweep.runs) return kExitFailed;
  }
  return kExitDone;
}

int submit(const std::vector<PlannedRun>& runs, SweepArguments& arguments, const std::string& folder) {
  if (runs.empty()) {
    if (!arguments.quiet) fmt::print("{}: nothing is to be done\n", folder);
    return exit_code_of(folder);
  }
  arguments.slurm.width = arguments.at_a_time.value_or(0);
  const SlurmSubmission submission = submit_to_slurm(runs, arguments.options, arguments.slurm, folder);
  if (!arguments.quiet) {
    fmt::print("{}: {} runs in {} tasks of job {}; job {} makes {}/table.md then\nlogs: {}\nevbench status {}\n",
               folder, runs.size(), submission.tasks, submission.array_job, submission.table_job, folder,
               submission.folder, folder);
  }
  return arguments.slurm.wait ? exit_code_of(folder) : kExitDone;
}

int write_manifest(const std::vector<PlannedRun>& runs, const SweepArguments& arguments, const std::string& folder) {
  const std::string manifest = folder + "/manifest.jsonl";
  write_file(manifest, format_manifest(runs, arguments.options));
  if (!arguments.quiet) {
    fmt::print("{}: {} lines; evbench task {} LINE does one\n", manifest, runs.size(), manifest);
  }
  return kExitDone;
}

int execute(SweepArguments& arguments, Plugins& plugins) {
  const Interruption interruption(arguments.file + ": interrupted; no run was started");
  stay_without_threads();
  const Announce announce = announcement(arguments.quiet);
  const LibraryPolicy policy = {.refused_by = arguments.dry_run ? "--dry-run" : "", .announce = announce};
  Sweep sweep = read_sweep(arguments.file, arguments.overrides, arguments.vary, plugins, policy);
  sweep.limits.seconds = arguments.seconds.value_or(sweep.limits.seconds);
  sweep.limits.memory_mib = arguments.memory_mib.value_or(sweep.limits.memory_mib);
  ExecutorOptions& options = arguments.options;
  options.limits = sweep.limits;
  options.processes = arguments.at_a_time.value_or(static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
  const SweepPlan plan = [&] {
    ProgressLine line(arguments.file, arguments.quiet);
    line.update("planning: making the sources to list their files");
    return plan_sweep(sweep, plugins);
  }();
  for (const std::string& remark : plan.remarks) announce(fmt::format("{}: {}", sweep.config, remark));
  const std::vector<PlannedRun> runs = select_runs(plan, arguments.only);
  if (runs.empty()) throw InputError(fmt::format("{}: no run has all the values of --only", sweep.place));
  if (arguments.dry_run) {
    print_plan(runs, plan, options);
    return kExitDone;
  }
  std::vector<const Job*> jobs;
  for (const PlannedRun& run : runs) jobs.push_back(&run.config.job);
  announce_commands(jobs, plugins, announce);
  const std::string folder = (std::filesystem::path(options.out) / plan.name).string();
  if (arguments.report) check_report_of(folder);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw OutputError(fmt::format("{}: can't be made: {}", folder, error.message()));
  write_file(folder + "/sweep.json", dump_json(plan.to_json(), 1) + "\n");
  if (arguments.executor == "local") {
    const int exit_code = do_locally(runs, arguments, folder, plugins);
    if (arguments.report) report_folder(folder, "evbench sweep " + arguments.file, arguments.quiet);
    return exit_code;
  }
  const std::vector<PlannedRun> left = runs_to_do(runs, plugins, options);
  return arguments.executor == "slurm" ? submit(left, arguments, folder) : write_manifest(left, arguments, folder);
}

}  // namespace

void add_sweep(CLI::App& app, Plugins& plugins, int& exit_code) {
  auto arguments = std::make_shared<SweepArguments>();
  CLI::App* command = app.add_subcommand("sweep", "Vary a config along axes: many runs, each in a process of its own");
  command->add_option("file", arguments->file, "JSON: a sweep, or a config (then with --vary)")->required();
  command
      ->add_option(
          "--vary", arguments->vary,
          "Vary the config over these values, another axis: KEY=VALUES, e.g. seed=1..5, KEY=a,b, KEY=0.01..1:7log")
      ->type_name("KEY=VALUES")
      ->allow_extra_args(false);
  add_overrides(*command, arguments->overrides, "Override a value of the base config: KEY=VALUE");
  command
      ->add_option("--only", arguments->only, "Only runs with this value on an axis; several of one axis: any of them")
      ->type_name("AXIS=VALUE")
      ->allow_extra_args(false);
  command->add_option("--out", arguments->options.out, "Folder for results")->capture_default_str();
  command
      ->add_option("-j,--jobs", arguments->at_a_time,
                   "Runs at a time: by default one per processor, or as many as Slurm starts; use 1 to compare times")
      ->check(CLI::Range(1, 4096));
  command->add_option("--timeout", arguments->seconds, "Time limit of a run [s]; 0: none")->check(not_negative());
  command->add_option("--memory", arguments->memory_mib, "Memory limit of a run [MiB]; 0: none")->check(not_negative());
  command->add_flag("--retry-failed", arguments->options.retry_failed,
                    "Repeat runs that crashed, hung or exceeded a limit, and damaged ones");
  command->add_flag("--report", arguments->report,
                    "local: also write OUT/NAME/report.html: a page of all its runs (evbench report)");
  command->add_flag(
      "--dry-run", arguments->dry_run,
      "Only print the plan and which of its runs are complete; loads no library that only the files name");
  command
      ->add_option("--executor", arguments->executor,
                   "local: processes on this machine; slurm: a job array; none: only write OUT/NAME/manifest.jsonl, "
                   "whose lines evbench task runs")
      ->check(one_of({"local", "slurm", "none"}))
      ->capture_default_str();
  command->add_option("--partition", arguments->slurm.partition, "Slurm: partition");
  command->add_option("--time", arguments->slurm.time,
                      "Slurm: time limit of a task, e.g. 30 or 2:00:00; by default from --timeout");
  command->add_option("--setup", arguments->slurm.setup,
                      "Slurm: a line of shell before each task, e.g. \"module load gcc\", or around it: "
                      "\"apptainer exec evbench.sif {}\"");
  command->add_flag("--wait", arguments->slurm.wait, "Slurm: return when the table is made");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  command->footer([] {
    return "A sweep's file:\n\n" + describe_sweep() +
           "docs/guides/sweep.md says what an axis is.\n"
           "A run that is complete below OUT is not repeated, so that a killed sweep can be continued. Several\n"
           "processes may run the same sweep. Exit codes: as of evbench run.";
  });
  command->callback([arguments, &plugins, &exit_code] { exit_code = execute(*arguments, plugins); });
}

}  // namespace evbench
