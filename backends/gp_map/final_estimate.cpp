#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "backends/gp_map/earlier_hypothesis.hpp"
#include "backends/gp_map/gp_map.hpp"
#include "core/support/seconds_since.hpp"

// When all has been seen: everything is estimated once more, and what follows from everything is learnt.
namespace evbench::gp_map {

void GpMap::finish() {
  const bool had_map = map_.has_value();
  const std::string reason = initial_map_.reason();  // while there were data: the last state stands after their end
  if (const std::optional<double> last = placement_.last()) step(*last);
  if (!map_) {
    monitor_.fail(std::min(initial_map_.newest(), until_),
                  "no initial map: " + (had_map ? initial_map_.reason() : reason));
    return;
  }
  map_->confirmed = true;  // nothing more will tell whether the map is right
  if (options_.final_iterations == 0) {
    map_->engine.settle();
    record_final_prior();
    return;
  }
  const auto start = std::chrono::steady_clock::now();
  if (options_.lag > 0.0) {
    // What is settled keeps its expansions: balanced anew alone, the rest would get another scale.
    const std::vector<double> surplus = surplus_expansions(map_->engine);
    for (int round = 0; round < options_.learn.rounds; ++round) {
      learn_from_smoothed({}, surplus);
      map_->engine.update();
    }
    add_record(graph().states.back().t, seconds_since(start), options_.learn.rounds, {});
    record_final_prior();
    return;
  }
  const Engine::OptimiseSummary summary = estimate_everything();
  context_.log(fmt::format("final estimate: cost {:.2f} after {:.2f}, {} iterations{}", summary.final_cost,
                           summary.initial_cost, summary.iterations, summary.converged ? "" : ", not converged"));
  add_record(graph().states.back().t, seconds_since(start), summary.iterations, summary.final_cost);
  record_final_prior();
}

/// Prior, noise, and what each track is worth follow from the estimate, and it from them.
Engine::OptimiseSummary GpMap::estimate_everything() {
  const bool learns_prior = options_.learn.prior != LearnPrior::never;
  const bool learns = learns_prior || options_.learn.noise;
  const int rounds = learns ? options_.learn.rounds : 1;
  constexpr int kIterationsARound = 3;
  constexpr double kRoughly = 1e-4, kLearnt = 1e-6, kFixed = 1e-9;  // what is learnt is known no better
  map_->engine.optimise(kIterationsARound, kRoughly);
  if (is_tentative()) reconsider_beginning();
  if (auto other = try_earlier_hypotheses(map_->engine, options_.health.min_landmarks)) {
    context_.log("what was seen earlier is explained better otherwise by what came after it");
    map_->engine = std::move(*other);
  }
  for (int round = 0; round < rounds; ++round) {
    if (options_.learn.noise) {
      map_->noise = learn_noise(graph());
      map_->engine.set_loss(map_->noise.loss(options_.loss, options_.loss_width));
    }
    if (learns_prior) learn_prior(map_->engine, {});
    reject_outliers(map_->noise, {});
    if (options_.learn.noise) weigh_tracks(map_->noise, {});
    const bool settled = map_->engine.optimise(kIterationsARound, kRoughly).iterations == 1;
    if (settled && round > 0) break;  // what is learnt does not change the estimate any more
  }
  return map_->engine.optimise(options_.final_iterations, learns ? kLearnt : kFixed);
}

/// What is near and what is far may have changed places, which little motion does not tell; a map that is older has
/// seen more. Not while running: before a plane, whose other explanation is looked for already, it misleads.
void GpMap::reconsider_beginning() {
  auto search = begin_search(StructureHypothesis::reversal, true);
  if (!search) return;
  while (search->go_on()) {
  }
  if (search->found()) go_on_with(*search->found());
}

/// Beside what had been learnt by each control state's update: the density, in the end, of the interval which ends
/// there.
void GpMap::record_final_prior() {
  for (UpdateRecord& record : updates_) {
    const int k = graph().interval_of(record.t);
    if (k > 0 && !record.learnt.empty()) std::ranges::copy(graph().qcs[index(k)], record.learnt.end() - 6);
  }
}

}  // namespace evbench::gp_map
