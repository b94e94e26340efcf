#include "bench/sweep/slurm_executor.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "bench/sweep/manifest.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

/// Slurm's own default, where it reports none.
constexpr std::size_t kMaxArraySize = 1001;

struct Answer {
  int exit_code = 0;
  std::string text;  ///< standard output and error
};

Answer shell(const std::string& command) {
  FILE* const pipe = ::popen((command + " 2>&1").c_str(), "r");  // NOLINT(cert-env33-c): words are quoted
  if (pipe == nullptr) throw InputError("no process can be had for Slurm's commands");
  Answer answer;
  std::array<char, 4096> bytes;
  while (const std::size_t count = std::fread(bytes.data(), 1, bytes.size(), pipe)) {
    answer.text.append(bytes.data(), count);
  }
  const int status = ::pclose(pipe);
  answer.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 1;
  while (answer.text.ends_with('\n')) answer.text.pop_back();
  return answer;
}

std::string quoted(const std::string& word) {
  std::string result = "'";
  for (const char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::size_t most_tasks() {
  std::istringstream config(shell("scontrol show config").text);
  for (std::string line; std::getline(config, line);) {
    std::size_t size = 0;
    const std::size_t equals = line.find('=');
    if (line.starts_with("MaxArraySize") && equals != std::string::npos) {
      if (std::istringstream(line.substr(equals + 1)) >> size && size > 1) return size - 1;
    }
  }
  return kMaxArraySize - 1;
}

/// Submits a script; returns the job's number.
std::string submit(const std::string& arguments, const std::string& script) {
  const Answer answer = shell(fmt::format("sbatch --parsable {} {}", arguments, quoted(script)));
  if (answer.exit_code == 127) {
    throw InputError("--executor slurm: there is no sbatch; expected Slurm's commands in the PATH");
  }
  // --parsable: the number alone, with ;CLUSTER after it where there are several; warnings come before it.
  const std::string last = answer.text.substr(answer.text.rfind('\n') + 1);
  const std::string number = last.substr(0, last.find(';'));
  if (number.empty() || number.find_first_not_of("0123456789") != std::string::npos) {
    std::string said = answer.text;
    std::ranges::replace(said, '\n', ' ');
    throw InputError(fmt::format("--executor slurm: Slurm refuses {}: {}", script, said));
  }
  return number;
}

/// The next SWEEP/slurm/N.
std::string make_folder(const std::string& sweep_folder) {
  const std::string parent = fs::absolute(sweep_folder).string() + "/slurm";
  std::error_code error;
  fs::create_directories(parent, error);
  for (int i = 1; !error; ++i) {
    const std::string folder = fmt::format("{}/{}", parent, i);
    if (fs::create_directory(folder, error)) return folder;
  }
  throw OutputError(fmt::format("{}: can't be made: {}", parent, error.message()));
}

/// The command with the setup.
std::string set_up(const std::string& setup, const std::string& command) {
  const std::size_t place = setup.find("{}");
  if (place == std::string::npos) return setup + "\n" + command + "\n";
  return std::string(setup).replace(place, 2, command) + "\n";
}

/// Time limit of a task [min]: enough for its runs, each with its limit, and for waiting for their shared inputs, each
/// made with the limit of a run.
std::string task_time(const std::vector<PlannedRun>& runs, const ExecutorOptions& options, const SlurmOptions& slurm,
                      std::size_t tasks) {
  if (!slurm.time.empty()) return slurm.time;
  if (options.limits.seconds == 0.0) return "";
  const bool tracks = std::ranges::any_of(runs, [](const PlannedRun& run) { return !run.tracks.empty(); });
  const bool events = std::ranges::any_of(runs, [](const PlannedRun& run) { return !run.events.empty(); });
  const std::size_t lines_each = (runs.size() + tasks - 1) / tasks;
  const auto limits = static_cast<double>(lines_each * (1U + (tracks ? 1U : 0U) + (events ? 1U : 0U)));
  return fmt::format("{:.0f}", std::ceil(options.limits.seconds * limits / 60.0) + 1.0);
}

/// Options of sbatch for the tasks. Its memory limit is above the run's, so that the run can report the reason.
std::string task_options(const ExecutorOptions& options, const SlurmOptions& slurm, const SlurmSubmission& submission,
                         const std::vector<PlannedRun>& runs) {
  std::string text = fmt::format("--requeue --array=1-{}", submission.tasks);
  if (slurm.width > 0) text += fmt::format("%{}", slurm.width);
  text += " --output=" + quoted(submission.folder + "/%a.log");
  const std::string time = task_time(runs, options, slurm, submission.tasks);
  if (!time.empty()) text += " --time=" + quoted(time);
  if (options.limits.memory_mib > 0.0) text += fmt::format(" --mem={:.0f}M", 1.25 * options.limits.memory_mib + 256.0);
  return text;
}

}  // namespace

SlurmSubmission submit_to_slurm(const std::vector<PlannedRun>& runs, const ExecutorOptions& options,
                                const SlurmOptions& slurm, const std::string& sweep_folder) {
  const std::string program = quoted(fs::read_symlink("/proc/self/exe").string());
  const std::string sweep = quoted(fs::absolute(sweep_folder).string());
  const std::string name = quoted("evbench-" + fs::path(sweep_folder).filename().string());
  std::string everywhere = fmt::format("--job-name={}", name);
  if (!slurm.partition.empty()) everywhere += " --partition=" + quoted(slurm.partition);

  SlurmSubmission submission;
  submission.tasks = std::min(runs.size(), most_tasks());
  submission.folder = make_folder(sweep_folder);
  const std::string manifest = submission.folder + "/manifest.jsonl";
  const std::string tasks = submission.folder + "/tasks.sh", table = submission.folder + "/table.sh";
  write_file(manifest, format_manifest(runs, options));
  const std::string shebang = "#!/bin/bash\n";
  const std::string task =
      fmt::format("exec {} task {} \"$SLURM_ARRAY_TASK_ID\" --stride {}", program, quoted(manifest), submission.tasks);
  write_file(tasks, shebang + set_up(slurm.setup, slurm.setup.find("{}") == std::string::npos ? task : task.substr(5)));
  write_file(table, shebang +
                        set_up(slurm.setup, fmt::format("{} table {} --format markdown --out {}/table.md --force",
                                                        program, sweep, sweep)) +
                        set_up(slurm.setup, fmt::format("{} status {} > {}/status.txt", program, sweep, sweep)));
  try {
    submission.array_job =
        submit(fmt::format("{} {}", everywhere, task_options(options, slurm, submission, runs)), tasks);
  } catch (const InputError&) {
    std::error_code ignored;
    fs::remove_all(submission.folder, ignored);
    throw;
  }
  submission.table_job =
      submit(fmt::format("{} --dependency=afterany:{} --output={} {}", everywhere, submission.array_job,
                         quoted(submission.folder + "/table.log"), slurm.wait ? "--wait" : ""),
             table);
  return submission;
}

}  // namespace evbench
