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
#include "bench/runner.hpp"
#include "bench/sweep/process_pool.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

using Clock = std::chrono::steady_clock;

/// How often runs that another process does are looked after.
constexpr std::chrono::milliseconds kLookElsewhere(500);

/// What a process of the pool tells. Text after "not written: " and "refused: ".
const std::string kWritten = "written",
                  kNotWritten = "not written: ", kRefused = "refused: ", kNotShared = "not shared";

/// The file in the folder of tracks that runs share.
constexpr const char* kBatches = "batches.bin";

/// In a process of its own: does the run and writes its folder. `tracks`: the folder of its front-end's, where they are
/// made already.
std::string do_run(const PlannedRun& run, const Plugins& plugins, const std::string& tracks, RunFolder& folder) {
  try {
    const Job& job = run.config.job;
    const std::unique_ptr<Source> source = make_source(job, plugins);
    const auto batches = tracks.empty() ? nullptr : RecordedBatches::open(tracks + "/" + kBatches);
    const Execution execution = batches ? execute(job, *source, plugins, *batches) : execute(job, *source, plugins, {});
    folder.write(run.config, run.identity, *source, ground_truth_tum(*source), execution);
    return kWritten;
  } catch (const OutputError& error) {
    return kNotWritten + error.what();
  } catch (const InputError& error) {
    return kRefused + error.what();
  }
}

/// In a process of its own: makes the tracks that runs share.
std::string make_tracks(const Job& job, const Plugins& plugins, AtomicFolder& folder) {
  try {
    const std::optional<std::string> batches = record_front_end(job, *make_source(job, plugins), plugins);
    if (!batches) return kNotShared;
    folder.write(kBatches, *batches);
    folder.commit();
    return kWritten;
  } catch (const OutputError& error) {
    return kNotWritten + error.what();
  }
}

class Executor {
 public:
  Executor(const std::vector<PlannedRun>& runs, const Plugins& plugins, const ExecutorOptions& options)
      : plugins_(plugins), options_(options) {
    std::set<std::string> keys;
    for (const PlannedRun& run : runs) {
      if (keys.insert(run.identity.key).second) jobs_.push_back({&run, options.retry_failed, false, nullptr});
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
    take_results();
    progress_.before = progress_.done;
    const Clock::time_point begin = Clock::now();
    while (progress_.done < progress_.runs) {
      check_interruption();
      start_some();
      for (const Ending& ending : pool_.wait(std::chrono::milliseconds(50))) take_ending(ending);
      if (Clock::now() - looked_ > kLookElsewhere) look_elsewhere();
      estimate(std::chrono::duration<double>(Clock::now() - begin).count());
      tell(progress_);
    }
    return std::move(progress_);
  }

 private:
  struct Job {
    const PlannedRun* run;
    bool retry;                         ///< what broke off is done again
    bool killed;                        ///< from outside, once
    std::unique_ptr<RunFolder> folder;  ///< its claim on the run
  };

  /// What a front-end gives, and several runs need.
  struct Tracks {
    std::string path;                      ///< its folder
    std::size_t id = 0;                    ///< of the process that makes it
    bool settled = false;                  ///< it is there, or every run makes it for itself
    std::unique_ptr<AtomicFolder> folder;  ///< the claim on it, while it is made
    std::vector<std::size_t> waiting;      ///< jobs
  };

  std::string folder_of(const Job& job) const {
    return fmt::format("{}/{}/{}", options_.out, job.run->config.experiment, job.run->identity.key);
  }

  void take_results() {
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      check_interruption();
      if (!take_result(jobs_[i])) waiting_.push_back(i);
    }
  }

  /// Takes what lies there already, if that is to be taken.
  bool take_result(Job& job) {
    AtomicFolder::clear_leftovers(folder_of(job));
    std::string why;
    const RunCondition condition = condition_of(folder_of(job), job.run->identity, why);
    if (condition == RunCondition::complete || condition == RunCondition::absent) {
      const auto found = find_complete_run(options_.out, job.run->config.experiment, job.run->identity);
      return found && adopt(job, *found);
    }
    if (job.retry) return false;
    fail(job, condition == RunCondition::damaged ? "damaged: " + why : why);
    return true;
  }

  /// Another process may be adopting it, too: it is then looked at again later.
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
    Tracks* const tracks = run.tracks.empty() ? nullptr : &tracks_of(run);
    if (tracks != nullptr && !tracks->settled) {
      get_tracks(*tracks, i);
      return;
    }
    try {
      job.folder = std::make_unique<RunFolder>(options_.out, run.config.experiment, run.identity.key);
    } catch (const FolderTaken&) {
      elsewhere_.push_back(i);
      job.retry = false;  // what that process makes of it is its result
      return;
    }
    std::string ignored;
    if (condition_of(folder_of(job), run.identity, ignored) == RunCondition::complete) {  // since it was looked at
      job.folder.reset();
      if (!take_result(job)) waiting_.push_back(i);
      return;
    }
    const std::string shared = tracks == nullptr ? "" : tracks->path;
    const auto work = [&] { return do_run(run, plugins_, shared, *job.folder); };
    pool_.start(i, work, options_.limits);
  }

  Tracks& tracks_of(const PlannedRun& run) {
    const auto known = tracks_.find(run.tracks);
    if (known != tracks_.end()) return known->second;
    Tracks& tracks = tracks_[run.tracks];
    tracks.path = fmt::format("{}/.tracks/{}", options_.out, run.tracks);
    tracks.id = jobs_.size() + tracks_made_++;
    AtomicFolder::clear_leftovers(tracks.path);
    tracks.settled = std::filesystem::exists(tracks.path);
    return tracks;
  }

  /// Has tracks made that a job needs; it begins when they are settled.
  void get_tracks(Tracks& tracks, std::size_t i) {
    if (!tracks.folder) {
      try {
        tracks.folder = std::make_unique<AtomicFolder>(tracks.path);
      } catch (const FolderTaken&) {  // another process makes them
        tracks_.erase(jobs_[i].run->tracks);
        elsewhere_.push_back(i);
        return;
      }
      const auto work = [&] { return make_tracks(jobs_[i].run->config.job, plugins_, *tracks.folder); };
      pool_.start(tracks.id, work, options_.limits);
    }
    tracks.waiting.push_back(i);
  }

  /// Tracks that could not be made are made by each run, which then says what is wrong.
  void settle_tracks(const Ending& ending) {
    if (ending.report.starts_with(kNotWritten)) throw OutputError(ending.report.substr(kNotWritten.size()));
    for (auto& [name, tracks] : tracks_) {
      if (tracks.id != ending.id) continue;
      tracks.settled = true;
      tracks.folder.reset();
      waiting_.insert(waiting_.begin(), tracks.waiting.begin(), tracks.waiting.end());
      tracks.waiting.clear();
    }
  }

  void take_ending(const Ending& ending) {
    if (ending.id >= jobs_.size()) {
      settle_tracks(ending);
      return;
    }
    Job& job = jobs_[ending.id];
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
    if (auto trouble = trouble_of(record, place_of(job.run->axes))) {
      add(std::move(*trouble));
    } else {
      ++progress_.done;
    }
  }

  void fail(const Job& job, const std::string& reason) { add({job.run->config.label, place_of(job.run->axes), reason}); }

  void add(TroubledRun run) {
    if (!run.lost) ++progress_.failed;
    progress_.troubled.push_back(std::move(run));
    ++progress_.done;
  }

  void estimate(double seconds) {
    const auto here = static_cast<double>(progress_.done - progress_.before);
    const auto left = static_cast<double>(progress_.runs - progress_.done);
    progress_.seconds_left = here > 0.0 ? seconds / here * left : 0.0;
  }

  const Plugins& plugins_;
  const ExecutorOptions& options_;
  std::vector<Job> jobs_;
  std::deque<std::size_t> waiting_;
  std::vector<std::size_t> elsewhere_;
  std::map<std::string, Tracks> tracks_;
  std::size_t tracks_made_ = 0;  ///< numbers of processes that were given to tracks
  Clock::time_point looked_ = {};
  SweepProgress progress_;
  ProcessPool pool_;  // the last one: its processes end before what they use
};

}  // namespace

std::string describe(const TroubledRun& run) {
  return fmt::format("{}: {}{}{}: {}", run.lost ? "lost" : "failed", run.label, run.place.empty() ? "" : ", ",
                     run.place, run.reason);
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
