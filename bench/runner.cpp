#include "bench/runner.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <chrono>
#include <cmath>
#include <fstream>

#include "bench/peak_memory.hpp"
#include "core/plugin/registry.hpp"
#include "core/support/sha256.hpp"

namespace evbench {
namespace {

constexpr double kChunk = 0.01;  // [s] of data between two calls of the back-end

/// peak_memory_mib() counts from here on.
void reset_peak_memory() {
  ::malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

class Stopwatch {
 public:
  template <class Call>
  void time(Call call) {
    const auto start = std::chrono::steady_clock::now();
    call();
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  double seconds() const { return seconds_; }

 private:
  double seconds_ = 0.0;
};

/// Pixels of the ideal pinhole; observations that have none are left out and counted.
class Undistorter {
 public:
  explicit Undistorter(const Camera& camera) : camera_(camera) {}

  void apply(std::vector<TrackObservation>& observations) {
    std::erase_if(observations, [&](TrackObservation& z) {
      const std::optional<Vector2> pixel = camera_.undistort(z.pixel);
      if (pixel) z.pixel = *pixel;
      left_out_ += pixel ? 0 : 1;
      return !pixel;
    });
  }
  std::size_t left_out() const { return left_out_; }

 private:
  const Camera& camera_;
  std::size_t left_out_ = 0;
};

void add_to_hash(Sha256& hash, const std::vector<TrackObservation>& observations) {
  for (const TrackObservation& z : observations) {
    hash.add_value(z.track);
    hash.add_value(z.t);
    hash.add_value(z.pixel.x());
    hash.add_value(z.pixel.y());
    hash.add_value(z.sigma);
  }
}

PoseTrajectory sample(const BackEnd& backend, double rate) {
  const PoseTrajectory own = backend.trajectory();
  if (rate == 0.0 || own.empty()) return own;
  std::vector<StampedPose> poses;
  const auto first = static_cast<std::int64_t>(std::ceil(own.start() * rate - 1e-9));
  for (std::int64_t k = first; static_cast<double>(k) / rate <= own.end(); ++k) {
    const double t = static_cast<double>(k) / rate;
    if (const std::optional<SE3> T = backend.pose(t)) poses.push_back({t, *T});
  }
  return PoseTrajectory(std::move(poses));
}

void score_into(const Source& source, const PoseTrajectory& trajectory, const RunConfig& config,
                std::optional<Scores>& scores, std::string& unscored) {
  if (source.ground_truth().empty()) {
    unscored = "no ground truth";
  } else if (trajectory.empty()) {
    unscored = "no trajectory";
  } else {
    ScoreOptions options = config.evaluation;
    if (options.time_range.empty()) options.time_range = {source.time_range().from, source.time_range().to};
    try {
      scores = score(source.ground_truth(), trajectory, options);
    } catch (const InputError& error) {
      unscored = error.what();
    }
  }
}

bool is_finite(const PoseTrajectory& trajectory) {
  for (const StampedPose& pose : trajectory.poses()) {
    if (!pose.T.p.allFinite() || !pose.T.q.coeffs().allFinite()) return false;
  }
  return true;
}

}  // namespace

std::unique_ptr<Source> make_source(const RunConfig& config) {
  const SourceContext context{config.seed, config.folder, config.source.place};
  return Registry<Source>::instance()
      .find(config.source.type, config.source.place)
      .make(config.source.options, config.source.place, context);
}

RunResult run(const RunConfig& config, const Source& source, const Progress& progress) {
  RunResult result;
  reset_peak_memory();
  const FrontEndContext frontend_context{source, config.seed, config.folder, config.frontend.place};
  const auto frontend = Registry<FrontEnd>::instance()
                            .find(config.frontend.type, config.frontend.place)
                            .make(config.frontend.options, config.frontend.place, frontend_context);
  BackEndContext backend_context;
  backend_context.camera = source.camera().pinhole;
  backend_context.seed = config.seed;
  backend_context.log = [&](const std::string& line) { result.log.push_back(line); };
  const auto backend = Registry<BackEnd>::instance()
                           .find(config.backend.type, config.backend.place)
                           .make(config.backend.options, config.backend.place, backend_context);

  const Source::TimeRange range = source.time_range();
  Undistorter undistorter(source.camera());
  Stopwatch stopwatch;
  Sha256 hash;
  std::vector<TrackObservation> observations;
  bool more = true;
  for (std::int64_t chunk = 1; more; ++chunk) {
    const double until = range.from + static_cast<double>(chunk) * kChunk;
    observations.clear();
    more = frontend->advance(until, observations) && until < range.to;
    undistorter.apply(observations);
    add_to_hash(hash, observations);
    result.observations += observations.size();
    stopwatch.time([&] {
      backend->observe(observations);
      backend->advance(until);
    });
    frontend->receive(backend->feedback());
    if (progress) progress(until, range.to);
  }
  stopwatch.time([&] { backend->finish(); });

  result.status = backend->status();
  result.final_trajectory = sample(*backend, config.trajectory_rate);
  result.online_trajectory = backend->online();
  if (!is_finite(result.final_trajectory) || !is_finite(result.online_trajectory)) {
    result.status = {RunState::failed, "the back-end's trajectory is not finite", range.to, {}};
    result.final_trajectory = result.online_trajectory = {};
  }
  result.map = backend->map();
  result.problem = backend->problem();
  result.updates.assign(backend->updates().begin(), backend->updates().end());
  result.runtime_s = stopwatch.seconds();
  result.data_s = range.to - range.from;
  result.peak_rss_mib = peak_memory_mib();
  result.tracks_sha256 = hash.hex();
  score_into(source, result.final_trajectory, config, result.final_scores, result.final_unscored);
  score_into(source, result.online_trajectory, config, result.online_scores, result.online_unscored);

  for (const auto& remark : source.remarks()) result.log.push_back("source: " + remark);
  for (const auto& remark : frontend->remarks()) result.log.push_back("frontend: " + remark);
  if (undistorter.left_out() > 0) {
    result.log.push_back(
        fmt::format("{} observations left out: the lens model has no inverse there", undistorter.left_out()));
  }
  result.files = source.files();
  for (const auto& file : frontend->files()) result.files.push_back(file);
  return result;
}

}  // namespace evbench
