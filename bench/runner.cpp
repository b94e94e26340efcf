#include "bench/runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <iterator>

#include "bench/pipeline/batch_recording.hpp"
#include "bench/pipeline/feedback_line.hpp"
#include "bench/pipeline/frontend_runner.hpp"
#include "core/events/event_front_end.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"
#include "eval/track_scores.hpp"

namespace evbench {
namespace {

/// The commands of one plugin of a job. Throws InputError for any command with --no-external.
std::vector<std::string> allowed_commands(const PluginEntry& entry, const PluginConfig& config,
                                          const Plugins& plugins) {
  std::vector<std::string> commands = entry.commands(config.options, config.place);
  if (commands.empty() || plugins.external_code_allowed()) return commands;
  throw InputError(fmt::format("{}: would run \"{}\", and external code is refused (--no-external)", config.place,
                               commands.front()));
}

std::unique_ptr<FrontEnd> make_frontend(const Job& job, const Source& source, const Plugins& plugins) {
  const auto& entry = plugins.of<FrontEnd>().find(job.frontend.type, job.frontend.place + ".type");
  allowed_commands(entry, job.frontend, plugins);
  return entry.make(job.frontend.options, {source, job.seed, job.folder, job.frontend.place});
}

std::unique_ptr<BackEnd> make_backend(const Job& job, const BackEndContext& context, const Plugins& plugins) {
  const auto& entry = plugins.of<BackEnd>().find(job.backend.type, job.backend.place + ".type");
  allowed_commands(entry, job.backend, plugins);
  return entry.make(job.backend.options, context);
}

BackEndContext context_of(const Job& job) {
  BackEndContext context;
  context.seed = job.seed;
  context.folder = job.folder;
  context.place = job.backend.place;
  return context;
}

Execution broken_off(double t, const std::string& error) {
  Execution execution;
  execution.complete = false;
  execution.result.status = {RunState::failed, "error: " + error, t, {}};
  execution.result.log.push_back("error: " + error);
  return execution;
}

/// Calls `run(make, report, keep)`, which makes back-ends by `make`, reports its progress, and keeps its tracks if it
/// shall: because they are asked for, or scored by the source's truth.
template <class Run>
Execution run_job(const Job& job, const Source& source, const Plugins& plugins, const Progress& progress,
                  bool keep_tracks, Run run) {
  std::exception_ptr bad_input;  // of the first back-end, before any work
  bool made = false;
  const MakeBackEnd make = [&](const BackEndContext& context) {
    try {
      std::unique_ptr<BackEnd> backend = make_backend(job, context, plugins);
      made = true;
      return backend;
    } catch (const InputError&) {
      if (!made) bad_input = std::current_exception();
      throw;
    }
  };
  double reached = source.time_range().from;
  const Progress report = [&](const RunProgress& now) {
    check_interruption();
    reached = now.t;
    if (progress) progress(now);
  };
  try {
    const std::shared_ptr<const PointTruth> truth = source.point_truth();
    Execution execution{run(make, report, keep_tracks || truth != nullptr), true};
    if (truth) {
      TrackBatch& tracks = *execution.result.tracks;
      std::ranges::stable_sort(tracks.ended, {}, &TrackEnd::t);
      execution.track_scores = score_tracks(tracks.observations, tracks.ended, *truth, source.time_range().to);
    }
    if (!keep_tracks) execution.result.tracks.reset();
    return execution;
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    if (bad_input) std::rethrow_exception(bad_input);
    return broken_off(reached, error.what());
  }
}

}  // namespace

Execution execute(const Job& job, const Source& source, const Plugins& plugins, const Progress& progress,
                  bool keep_tracks) {
  std::unique_ptr<FrontEnd> frontend;
  try {
    frontend = make_frontend(job, source, plugins);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {  // e.g. a process that ends at once
    return broken_off(source.time_range().from, error.what());
  }
  return run_job(
      job, source, plugins, progress, keep_tracks, [&](const MakeBackEnd& make, const Progress& report, bool keep) {
        return run_pipeline(source, *frontend, make, context_of(job), job.pipeline, job.trajectory_rate, report, keep);
      });
}

Execution execute(const Job& job, const Source& source, const Plugins& plugins, BatchStream& batches) {
  return run_job(job, source, plugins, {}, false, [&](const MakeBackEnd& make, const Progress& report, bool keep) {
    return run_pipeline(source, batches, make, context_of(job), job.pipeline, job.trajectory_rate, report, keep);
  });
}

std::optional<std::string> record_front_end(const Job& job, const Source& source, const Plugins& plugins) {
  const std::unique_ptr<FrontEnd> frontend = make_frontend(job, source, plugins);
  if (frontend->needs().any) return std::nullopt;
  FeedbackLine unused(job.pipeline.latency, false);
  FrontEndRunner front(*frontend, source, job.pipeline, unused);
  return record_batches(front);
}

std::vector<std::string> check_job(const Job& job, const Source& source, const Plugins& plugins) {
  std::vector<std::string> unchecked;
  const auto starts_none = [&](const PluginEntry& entry, const PluginConfig& config) {
    const std::vector<std::string> commands = allowed_commands(entry, config, plugins);
    for (const std::string& command : commands) {
      unchecked.push_back(fmt::format("{}: \"{}\" was not started", config.place, command));
    }
    return commands.empty();
  };
  if (starts_none(plugins.of<FrontEnd>().find(job.frontend.type, job.frontend.place + ".type"), job.frontend)) {
    make_frontend(job, source, plugins);
  }
  BackEndContext context = context_of(job);
  context.camera = source.camera().pinhole;
  context.patience = job.pipeline.patience;
  if (starts_none(plugins.of<BackEnd>().find(job.backend.type, job.backend.place + ".type"), job.backend)) {
    make_backend(job, context, plugins);
  }
  const auto& frontend = plugins.of<FrontEnd>().find(job.frontend.type, job.frontend.place + ".type");
  if (frontend.reads_events) expect_events(source, job.frontend.place);
  return unchecked;
}

std::vector<std::string> commands_of(const Job& job, const Plugins& plugins) {
  const auto& frontend = plugins.of<FrontEnd>().find(job.frontend.type, job.frontend.place + ".type");
  const auto& backend = plugins.of<BackEnd>().find(job.backend.type, job.backend.place + ".type");
  std::vector<std::string> commands = allowed_commands(frontend, job.frontend, plugins);
  std::ranges::move(allowed_commands(backend, job.backend, plugins), std::back_inserter(commands));
  return commands;
}

}  // namespace evbench
