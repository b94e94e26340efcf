#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "backends/gp_map/gp_map.hpp"
#include "backends/gp_map/track_errors.hpp"
#include "core/support/seconds_since.hpp"

// When all has been seen: everything is estimated once more, and what follows from everything is learnt.
namespace evbench::gp_map {

void GpMap::finish() {
  if (const std::optional<double> last = placement_.last()) step(*last);
  if (!engine_) {
    monitor_.fail(first_map_.newest(),
                  first_map_.reason().empty() ? "no observations" : "no first map: " + first_map_.reason());
    return;
  }
  if (options_.final_iterations == 0) {
    engine_->settle();
    return;
  }
  const auto start = std::chrono::steady_clock::now();
  if (options_.lag > 0.0) {
    for (int round = 0; options_.learn.prior != LearnPrior::never && round < options_.learn.rounds; ++round) {
      learn_prior(*engine_);
      engine_->update();
    }
    record_final_prior();
    add_record(graph().states.back().t, seconds_since(start), options_.learn.rounds, {});
    return;
  }
  const Engine::OptimiseSummary summary = estimate_everything();
  record_final_prior();
  context_.log(fmt::format("final estimate: cost {:.2f} after {:.2f}, {} iterations{}", summary.final_cost,
                           summary.initial_cost, summary.iterations, summary.converged ? "" : ", not converged"));
  add_record(graph().states.back().t, seconds_since(start), summary.iterations, summary.final_cost);
}

/// Prior, noise, and what each track is worth follow from the estimate, and it from them.
Engine::OptimiseSummary GpMap::estimate_everything() {
  const bool learns_prior = options_.learn.prior != LearnPrior::never;
  const bool learns = learns_prior || options_.learn.noise;
  const int rounds = learns ? options_.learn.rounds : 1;
  constexpr int kIterationsARound = 3;
  constexpr double kRoughly = 1e-4, kLearnt = 1e-6, kFixed = 1e-9;  // what is learnt is known no better
  engine_->optimise(kIterationsARound, kRoughly);
  for (int round = 0; round < rounds; ++round) {
    const NoiseLearner noise = learn_noise(graph());
    if (options_.learn.noise) {
      noise_ = noise;
      engine_->set_loss(noise_.loss(options_.loss, options_.loss_width));
    }
    if (learns_prior) learn_prior(*engine_);
    judge_tracks(noise);
    const bool settled = engine_->optimise(kIterationsARound, kRoughly).iterations == 1;
    if (settled && round > 0) break;  // what is learnt does not change the estimate any more
  }
  return engine_->optimise(options_.final_iterations, learns ? kLearnt : kFixed);
}

/// Landmarks of which the track says something else. Where most of the tracks that are seen together do, it is the
/// motion that is wrong, and none of them.
std::vector<int> GpMap::outliers(const NoiseLearner& noise) const {
  std::vector<int> far;
  std::vector<int> seen_in(graph().intervals.size()), far_in(seen_in);
  for (int j = 0; j < static_cast<int>(graph().landmarks.size()); ++j) {
    const auto& landmark = graph().landmarks[index(j)];
    if (!landmark.alive) continue;
    const bool is_far = TrackErrors(graph(), j, noise).is_outlier(options_.map.outlier_threshold);
    if (is_far) far.push_back(j);
    for (const int k : landmark.intervals) {
      ++seen_in[index(k)];
      far_in[index(k)] += is_far ? 1 : 0;
    }
  }
  std::erase_if(far, [&](int j) {
    const auto& intervals = graph().landmarks[index(j)].intervals;
    const auto wrong =
        std::ranges::count_if(intervals, [&](int k) { return 2 * far_in[index(k)] > seen_in[index(k)]; });
    return 2 * wrong > std::ssize(intervals);
  });
  return far;
}

/// Of a full history. Outliers go, a track that slid keeps its landmark up to there, and each counts with its own
/// noise.
void GpMap::judge_tracks(const NoiseLearner& noise) {
  const double threshold = options_.map.outlier_threshold;
  const auto landmarks = static_cast<int>(graph().landmarks.size());
  for (const int outlier : outliers(noise)) become_outlier(outlier);
  FactorGraph judged = graph();
  for (int j = 0; j < landmarks; ++j) {
    if (!judged.landmarks[index(j)].alive) continue;
    const TrackErrors errors(judged, j, noise);
    if (options_.learn.noise) judged.scale_sigmas(j, errors.sigma_scale());
    if (const auto from = errors.slides_from(threshold)) judged.remove_observations(j, *from);
  }
  engine_.emplace(std::move(judged), EngineOptions());
}

/// Of each control state's update, in place of the density that it began with: that of the interval which ends there.
void GpMap::record_final_prior() {
  for (UpdateRecord& record : updates_) {
    const int k = graph().interval_of(record.t);
    if (k > 0 && !record.learnt.empty()) std::ranges::copy(graph().qcs[index(k)], record.learnt.end() - 6);
  }
}

}  // namespace evbench::gp_map
