#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "backends/gp_map/gp_map.hpp"
#include "backends/gp_map/map_validation.hpp"
#include "core/support/seconds_since.hpp"

// The final estimate: with all data known, the parameters and the whole trajectory are estimated once more.
namespace evbench::gp_map {

void GpMap::finish() {
  const bool had_map = map_.has_value();
  const std::string reason = initial_map_.reason();  // before the last state, which is later than the data
  if (const std::optional<double> last = placement_.last()) step(*last);
  if (!map_) {
    monitor_.fail(std::min(initial_map_.newest(), until_),
                  "no initial map: " + (had_map ? initial_map_.reason() : reason));
    return;
  }
  map_->confirmed = true;  // no more data will confirm the map
  if (options_.final_iterations == 0) {
    map_->engine.settle();
    record_final_prior();
    return;
  }
  const auto start = std::chrono::steady_clock::now();
  if (options_.lag > 0.0) {
    // Marginalised intervals keep their expansions: balancing only the others again would change their scale.
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
  validate_map();
  record_final_prior();
}

/// Estimates prior, noise and the weights of the tracks from the trajectory, and the trajectory with them.
Engine::OptimiseSummary GpMap::estimate_everything() {
  const bool learns_prior = options_.learn.prior != LearnPrior::never;
  const bool learns = learns_prior || options_.learn.noise;
  const int rounds = learns ? options_.learn.rounds : 1;
  constexpr int kIterationsARound = 3;
  constexpr double kRoughly = 1e-4, kEstimated = 1e-6, kFixed = 1e-9;  // estimated parameters are not more accurate
  map_->engine.optimise(kIterationsARound, kRoughly);
  if (options_.parts.reversal && is_tentative()) test_depth_reversal();
  for (int round = 0; round < rounds; ++round) {
    if (options_.learn.noise) {
      map_->noise = learn_noise(graph());
      map_->engine.set_loss(map_->noise.loss(options_.loss, options_.loss_width));
    }
    if (learns_prior) learn_prior(map_->engine, {});
    if (options_.parts.outliers) reject_outliers(map_->noise, {});
    if (options_.learn.noise && options_.parts.track_noise) estimate_track_noise(map_->noise, {});
    const bool settled = map_->engine.optimise(kIterationsARound, kRoughly).iterations == 1;
    if (settled && round > 0) break;  // the estimated parameters no longer change the estimate
  }
  return map_->engine.optimise(options_.final_iterations, learns ? kEstimated : kFixed);
}

/// An estimate that its own data contradict says so. Both halves of a wrong map may agree, though, where most tracks
/// are wrong in the same way.
void GpMap::validate_map() {
  const ValidationOptions& validation = options_.validation;
  if (!validation.enabled || monitor_.lost()) return;
  const std::optional<double> difference = difference_of_halves(graph(), validation);
  if (!difference) return;
  const std::string words = fmt::format("two halves of the map disagree by {:.2g} % of the path", 100.0 * *difference);
  context_.log("final estimate: " + words);
  if (*difference > validation.disagreement) {
    monitor_.doubt(graph().states.front().t, std::min(graph().states.back().t, until_), words);
  }
}

/// Tests whether near and far are swapped in the initial map, which little motion does not show; an older map has seen
/// more motion. Not while running: in front of a plane, whose dual is tested already, it misleads.
void GpMap::test_depth_reversal() {
  auto search = begin_search(StructureHypothesis::reversal, true);
  if (!search) return;
  while (search->run_share()) {
  }
  if (search->found()) adopt(*search->found());
}

/// Adds to the record of each control state's update the final density of the interval that ends there.
void GpMap::record_final_prior() {
  for (UpdateRecord& record : updates_) {
    const int k = graph().interval_of(record.t);
    if (k > 0 && !record.estimated.empty()) std::ranges::copy(graph().qcs[index(k)], record.estimated.end() - 6);
  }
}

}  // namespace evbench::gp_map
