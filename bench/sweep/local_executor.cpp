#include "bench/sweep/local_executor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "bench/pipeline/batch_recording.hpp"
#include "bench/run_folder.hpp"
#include "bench/run_index.hpp"
#include "bench/runner.hpp"
#include "bench/sweep/process_pool.hpp"
#include "bench/sweep/shared_events.hpp"
#include "bench/sweep/time_left.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

using Clock = std::chrono::steady_clock;

/// How often runs of other processes are checked.
constexpr std::chrono::milliseconds kLookElsewhere(500);

/// Reports of a process of the pool. More text follows "not written: " and "refused: ".
const std::string kWritten = "written",
                  kNotWritten = "not written: ", kRefused = "refused: ", kNotShared = "not shared";

/// Files with shared inputs that are made already: its front-end's tracks, its source's events; empty: none.
struct SharedFiles {
  std::string tracks, events;
};

std::unique_ptr<Source> make_source(const Job& job, const Plugins& plugins, const SharedFiles& shared) {
  std::unique_ptr<Source> source = make_source(job, plugins);
  return shared.events.empty() ? std::move(source) : with_recorded_events(std::move(source), shared.events);
}

/// Seeds hardly affect how long a run takes.
RunDurations::Traits traits_of(const PlannedRun& run) {
  RunDurations::Traits traits{run.config.label, {}};
  for (const auto& [axis, value] : run.axes) {
    if (axis != "seed") traits.values.push_back(axis + "=" + value);
  }
  return traits;
}

/// Does the run and writes its folder, in a process of its own.
std::string do_run(const PlannedRun& run, const Plugins& plugins, const SharedFiles& shared, const RunOutputs& outputs,
                   RunFolder& folder) {
  try {
    const Job& job = run.config.job;
    const auto batches = shared.tracks.empty() ? nullptr : RecordedBatches::open(shared.tracks);
    const std::unique_ptr<Source> source = make_source(job, plugins, batches ? SharedFiles() : shared);
    const Execution execution =
        batches ? execute(job, *source, plugins, *batches) : execute(job, *source, plugins, {}, outputs.tracks);
    folder.write(run.config, run.identity, *source, ground_truth_tum(*source), execution, outputs.problem);
    return kWritten;
  } catch (const OutputError& error) {
    return kNotWritten + error.what();
  } catch (const InputError& error) {
    return kRefused + error.what();
  }
}

/// The one file in the folder of a shared input.
constexpr const char *kBatches = "batches.bin", *kEvents = "events.evb";

/// Makes a shared input, each in a process of its own.
bool make_tracks(const Job& job, const Plugins& plugins, const SharedFiles& shared, const AtomicFolder& folder) {
  const std::optional<std::string> batches = record_front_end(job, *make_source(job, plugins, shared), plugins);
  if (batches) folder.write(kBatches, *batches);
  return batches.has_value();
}
bool make_events(const Job& job, const Plugins& plugins, const SharedFiles& /*shared*/, const AtomicFolder& folder) {
  return record_events(*make_source(job, plugins), folder.part() + "/" + kEvents);
}

std::string make_shared_files(decltype(make_tracks)* make, const Job& job, const Plugins& plugins,
                              const SharedFiles& shared, AtomicFolder& folder) {
  try {
    if (!make(job, plugins, shared, folder)) return kNotShared;
    folder.commit();
    return kWritten;
  } catch (const OutputError&) {
    return kNotShared;  // a full disk: runs may still have room for their results, or else report it
  }
}

std::string shown_duration(double seconds) {
  if (seconds < 90.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 5400.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
}

class Executor {
 public:
  Executor(const std::vector<PlannedRun>& runs, const Plugins& plugins, const ExecutorOptions& options)
      : plugins_(plugins),
        options_(options),
        index_(runs.empty() ? "" : options.out + "/" + runs.front().config.experiment) {
    std::set<std::string> keys;
    for (const PlannedRun& run : runs) {
      if (!keys.insert(run.identity.key).second) continue;
      jobs_.push_back({&run, options.retry_failed, false, nullptr});
      ++users_[run.events];
    }
    progress_.runs = jobs_.size();
  }

  std::vector<PlannedRun> to_do() {
    take_results();
    std::vector<PlannedRun> runs;
    for (const std::size_t i : waiting_) runs.push_back(*jobs_[i].run);
    return runs;
  }

  SweepProgress run(const std::function<void(const SweepProgress&)>& tell) {
    try {
      take_results();
      do_all(tell);
    } catch (const Interrupted&) {
      index_.write();
      throw;
    }
    index_.write();
    return std::move(progress_);
  }

 private:
  struct Job {
    const PlannedRun* run;
    bool retry;                                     ///< an interrupted run is done again
    bool killed;                                    ///< from outside, once
    std::unique_ptr<RunFolder> folder;              ///< its claim on the run
    std::optional<Clock::time_point> started = {};  ///< while its process runs
  };

  /// A shared input: the output of a front-end or a source that several runs need.
  struct Shared {
    std::string path;  ///< its folder
    const char* file;  ///< in it
    decltype(make_tracks)* make;
    std::size_t id = 0;                              ///< of the process that makes it
    bool settled = false;                            ///< it is made, or every run makes it for itself
    std::unique_ptr<AtomicFolder> folder = nullptr;  ///< the claim on it, while it is made
    std::vector<std::size_t> waiting = {};           ///< jobs
  };

  void do_all(const std::function<void(const SweepProgress&)>& tell) {
    progress_.before = progress_.done;
    while (progress_.done < progress_.runs) {
      check_interruption();
      start_some();
      for (const Ending& ending : pool_.wait(std::chrono::milliseconds(50))) take_ending(ending);
      if (Clock::now() - looked_ > kLookElsewhere) look_elsewhere();
      estimate();
      if (progress_.done > indexed_) index_.add();
      indexed_ = progress_.done;
      tell(progress_);
    }
  }

  std::string folder_of(const Job& job) const { return folder_of(*job.run, job.run->identity.key); }
  std::string folder_of(const PlannedRun& run, const std::string& key) const {
    return fmt::format("{}/{}/{}", options_.out, run.config.experiment, key);
  }

  void take_results() {
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      check_interruption();
      if (options_.force || !take_result(jobs_[i])) waiting_.push_back(i);
    }
    keep_together();
  }

  /// Sorts jobs by their events, so that the events can be removed soon.
  void keep_together() {
    std::map<std::string, std::size_t> firsts;
    for (const std::size_t i : waiting_) firsts.emplace(jobs_[i].run->events, i);
    const auto place = [&](std::size_t i) {
      const std::string& events = jobs_[i].run->events;
      return events.empty() ? i : firsts.at(events);
    };
    std::ranges::stable_sort(waiting_, {}, place);
  }

  /// Takes an existing result, if it may be taken. Not while a process writes to it, such as a killed sweep's run in
  /// its last moment: that result is checked later.
  bool take_result(Job& job) {
    if (AtomicFolder::is_taken(folder_of(job))) return false;
    AtomicFolder::clear_leftovers(folder_of(job));
    std::string why;
    const RunCondition condition = condition_of(folder_of(job), job.run->identity.key, why);
    if (condition == RunCondition::complete || condition == RunCondition::absent) {
      const auto found = find_complete_run(options_.out, job.run->config.experiment, job.run->identity);
      return found && options_.outputs.are_in(*found) && adopt(job, *found);
    }
    if (job.retry) return false;
    fail(job, condition == RunCondition::damaged ? "damaged: " + why : why);
    return true;
  }

  bool is_complete(const Job& job) const {
    std::string ignored;
    return !options_.force && options_.outputs.are_in(folder_of(job)) &&
           condition_of(folder_of(job), job.run->identity.key, ignored) == RunCondition::complete;
  }

  /// Another process may be adopting it as well: it is then checked again later.
  bool adopt(Job& job, const std::string& from) {
    try {
      count(job, adopt_run(from, folder_of(job), job.run->config));
      return true;
    } catch (const FolderTaken&) {
      return false;
    }
  }

  void start_some() {
    while (pool_.size() < static_cast<std::size_t>(options_.processes) && !waiting_.empty()) {
      const std::size_t i = waiting_.front();
      waiting_.pop_front();
      start(i);
    }
    progress_.running = pool_.size();
    progress_.elsewhere = elsewhere_.size();
  }

  void start(std::size_t i) {
    Job& job = jobs_[i];
    const PlannedRun& run = *job.run;
    // Shared tracks are as the back-end gets them, not as they were published.
    Shared* const tracks = shared(options_.outputs.tracks ? "" : run.tracks, "tracks", kBatches, make_tracks);
    Shared* const events = shared(run.events, "events", kEvents, make_events);
    if (file_of(tracks).empty() && !get(events, i, {})) return;
    SharedFiles files{"", file_of(events)};
    if (!get(tracks, i, files)) return;
    files.tracks = file_of(tracks);
    try {
      job.folder = std::make_unique<RunFolder>(options_.out, run.config.experiment, run.identity.key);
    } catch (const FolderTaken&) {
      elsewhere_.push_back(i);
      job.retry = false;  // that process' result counts
      return;
    }
    if (is_complete(job)) {  // since the last check
      job.folder.reset();
      if (!take_result(job)) waiting_.push_back(i);
      return;
    }
    const auto work = [&] { return do_run(run, plugins_, files, options_.outputs, *job.folder); };
    pool_.start(i, work, options_.limits);
    job.started = Clock::now();
  }

  /// The shared input of this name; nullptr where there is no name.
  Shared* shared(const std::string& name, const char* kind, const char* file, decltype(make_tracks)* make) {
    if (name.empty()) return nullptr;
    const std::string path = fmt::format("{}/.{}/{}", options_.out, kind, name);
    const auto [found, is_new] = shared_.try_emplace(path, Shared{path, file, make});
    if (is_new) {
      found->second.id = jobs_.size() + shared_made_++;
      AtomicFolder::clear_leftovers(path);
      found->second.settled = std::filesystem::exists(path);
    }
    return &found->second;
  }

  static std::string file_of(const Shared* shared) {
    const std::string path = shared == nullptr ? "" : shared->path + "/" + shared->file;
    return !path.empty() && shared->settled && std::filesystem::exists(path) ? path : "";
  }

  /// Ensures that a shared input of a job is made. False where the job has to wait; it begins again when the input is
  /// settled. `files`: the input files that it is made of.
  bool get(Shared* shared, std::size_t i, const SharedFiles& files) {
    if (shared == nullptr || shared->settled) return true;
    if (!shared->folder) {
      try {
        shared->folder = std::make_unique<AtomicFolder>(shared->path);
      } catch (const FolderTaken&) {  // another process makes it
        shared_.erase(std::string(shared->path));
        elsewhere_.push_back(i);
        return false;
      }
      const auto work = [&] {
        return make_shared_files(shared->make, jobs_[i].run->config.job, plugins_, files, *shared->folder);
      };
      pool_.start(shared->id, work, options_.limits);
    }
    shared->waiting.push_back(i);
    return false;
  }

  /// An input that could not be made is made by each run, which then reports the error.
  void settle(const Ending& ending) {
    for (auto& [path, shared] : shared_) {
      if (shared.id != ending.id) continue;
      shared.settled = true;
      shared.folder.reset();
      waiting_.insert(waiting_.begin(), shared.waiting.begin(), shared.waiting.end());
      shared.waiting.clear();
    }
  }

  /// Ends a job. Removes events that no job needs any more, as they are large.
  void leave(const Job& job) {
    const std::string& events = job.run->events;
    if (--users_[events] > 0 || events.empty()) return;
    std::error_code ignored;
    for (const std::string& key : job.run->events_for) {
      if (!std::filesystem::exists(folder_of(*job.run, key), ignored)) return;
    }
    std::filesystem::remove_all(fmt::format("{}/.events/{}", options_.out, events), ignored);
    std::filesystem::remove(options_.out + "/.events", ignored);  // the last one
  }

  void take_ending(const Ending& ending) {
    if (ending.id >= jobs_.size()) {
      settle(ending);
      return;
    }
    Job& job = jobs_[ending.id];
    job.started.reset();
    if (!ending.from_outside) durations_.add(traits_of(*job.run), ending.seconds);
    if (ending.report == kWritten) {
      job.folder.reset();
      count(job, read_record(folder_of(job)));
      return;
    }
    if (ending.report.starts_with(kNotWritten)) throw OutputError(ending.report.substr(kNotWritten.size()));
    const bool refused = ending.report.starts_with(kRefused);
    const std::string reason = refused ? "error: " + ending.report.substr(kRefused.size()) : ending.reason;
    if (ending.from_outside && !job.killed) {
      job.killed = true;
      job.folder.reset();
      waiting_.push_front(ending.id);
      return;
    }
    std::vector<std::string> log = ending.log;
    log.push_back(fmt::format("{} (the run's process took {:.1f} s)", reason, ending.seconds));
    job.folder->write_broken_off(job.run->config, job.run->identity, reason, log);
    job.folder.reset();
    fail(job, reason);
  }

  void look_elsewhere() {
    looked_ = Clock::now();
    std::erase_if(elsewhere_, [&](std::size_t i) {
      if (AtomicFolder::is_taken(folder_of(jobs_[i]))) return false;
      if (!take_result(jobs_[i])) waiting_.push_back(i);
      return true;
    });
  }

  void count(const Job& job, const RunRecord& record) {
    leave(job);
    if (auto trouble = trouble_of(record, place_of(job.run->axes))) {
      add(std::move(*trouble));
    } else {
      ++progress_.done;
    }
  }

  void fail(const Job& job, const std::string& reason) {
    leave(job);
    add({job.run->config.label, place_of(job.run->axes), reason});
  }

  void add(TroubledRun run) {
    if (!run.lost) ++progress_.failed;
    progress_.troubled.push_back(std::move(run));
    ++progress_.done;
  }

  /// Updates the expected time left when a run has ended. Runs of other processes count as if they had just begun.
  void estimate() {
    const auto now = Clock::now();
    if (progress_.done != estimated_at_) {
      estimated_at_ = progress_.done;
      std::vector<double> seconds;
      for (const Job& job : jobs_) {
        if (job.started) {
          const double so_far = std::chrono::duration<double>(now - *job.started).count();
          seconds.push_back(std::max(0.0, durations_.expected(traits_of(*job.run)) - so_far));
        }
      }
      for (const std::size_t i : elsewhere_) seconds.push_back(durations_.expected(traits_of(*jobs_[i].run)));
      for (const std::size_t i : waiting_) seconds.push_back(durations_.expected(traits_of(*jobs_[i].run)));
      const auto processes = static_cast<std::size_t>(options_.processes) + elsewhere_.size();
      done_at_ = now + std::chrono::duration_cast<Clock::duration>(
                           std::chrono::duration<double>(time_left(seconds, processes)));
    }
    progress_.seconds_left = std::max(0.0, std::chrono::duration<double>(done_at_ - now).count());
  }

  const Plugins& plugins_;
  const ExecutorOptions& options_;
  std::vector<Job> jobs_;
  std::deque<std::size_t> waiting_;
  std::vector<std::size_t> elsewhere_;
  std::map<std::string, Shared> shared_;      ///< by path
  std::size_t shared_made_ = 0;               ///< process ids given to shared inputs
  std::map<std::string, std::size_t> users_;  ///< jobs that are not done, by the events that they need
  Clock::time_point looked_ = {};
  RunDurations durations_;
  std::optional<std::size_t> estimated_at_;  ///< runs that were done at the estimate
  Clock::time_point done_at_ = {};           ///< expected end at the estimate
  RunIndex index_;
  std::size_t indexed_ = 0;  ///< runs that were done when the index was updated
  SweepProgress progress_;
  ProcessPool pool_;  // the last member: its processes end before the data that they use
};

}  // namespace

bool RunOutputs::are_in(const std::string& folder) const {
  return (!problem || std::filesystem::exists(folder + "/problem.txt")) &&
         (!tracks || std::filesystem::exists(folder + "/track_ends.txt"));
}

std::string describe(const TroubledRun& run) {
  return fmt::format("{}: {}{}{}: {}", run.lost ? "lost" : "failed", run.label, run.place.empty() ? "" : ", ",
                     run.place, run.reason);
}

std::string describe(const SweepProgress& now) {
  std::string text = fmt::format("{} of {} done", now.done, now.runs);
  if (now.failed > 0) text += fmt::format(", {} failed", now.failed);
  text += fmt::format(", {} running", now.running);
  if (now.elsewhere > 0) text += fmt::format(", {} elsewhere", now.elsewhere);
  if (now.seconds_left > 0.0) text += fmt::format(", about {} left", shown_duration(now.seconds_left));
  return text;
}

std::optional<TroubledRun> trouble_of(const RunRecord& record, const std::string& place) {
  if (!record.status || record.status->status.state < RunState::lost) return std::nullopt;
  const Status& status = record.status->status;
  if (status.state == RunState::failed) return TroubledRun{record.label, place, status.reason};
  return TroubledRun{record.label, place, fmt::format("lost at {:.1f} s: {}", status.time, status.reason), true};
}

std::vector<PlannedRun> runs_to_do(const std::vector<PlannedRun>& runs, const Plugins& plugins,
                                   const ExecutorOptions& options) {
  return Executor(runs, plugins, options).to_do();
}

SweepProgress do_runs(const std::vector<PlannedRun>& runs, const Plugins& plugins, const ExecutorOptions& options,
                      const std::function<void(const SweepProgress&)>& progress) {
  return Executor(runs, plugins, options).run(progress);
}

}  // namespace evbench
