#include "backends/gp_map/modules/prior_relaxation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "backends/gp_map/factors.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {
namespace {

/// Median error of the tracks seen in the newest interval, each at its last observation; 0: too few tracks. Unit: the
/// sigma of a track's mean error, as for the rejection of outliers, because trackers drift and this is no motion; but
/// at most a few pixel sigmas, because many tracks do not drift in common by chance.
double newest_error(const Estimate& estimate) {
  constexpr double kMostDrift = 3.0;
  const FactorGraph& graph = estimate.graph();
  const std::size_t k = graph.states.size() - 1;
  const GpInterval interval(graph.states[k - 1], graph.states[k]);
  const double scale = std::min(kMostDrift * estimate.noise.scale(), estimate.noise.scale_of_means());
  std::vector<double> errors;
  for (const auto& group : graph.intervals[k].groups()) {
    const Observation& z = graph.intervals[k].of(group).back();
    const Vector3& position = graph.landmarks[index(group.landmark)].position;
    errors.push_back(reprojection_residual(interval, position, z, graph.camera).norm() / scale);
  }
  return std::ssize(errors) < estimate.enough() ? 0.0 : median(std::move(errors));
}

}  // namespace

void RelaxationOptions::declare(OptionSet& set) {
  set.add("enabled", enabled, "the prior is relaxed while it suppresses the motion");
  set.add("error", error, "median error of the newest observations that shows it [sigmas of a track's mean error]")
      .above(0.0);
  set.add("most", most, "times weaker than the given prior, at most").range(1.0, 1e12);
  set.add("intervals", intervals, "newest intervals of the motion that are relaxed").range(1, 100);
}

double worthwhile_relaxation(double error, double allowed, double most,
                             const std::function<double(double)>& error_at) {
  constexpr double kWeaker = 10.0;  // per attempt
  constexpr double kHelp = 0.95;    // attempts go on while the error falls below this share of the last one
  constexpr double kWorthInAll = 0.8, kWorthEach = 0.9;  // remaining share: in all; per attempt since the last one kept
  const double before = error;
  double worth = error, kept = 1.0;
  for (double tried = 1.0; error > allowed && tried < most;) {
    tried *= kWeaker;
    worth *= kWorthEach;
    const double now = error_at(tried);
    if (!(now < kHelp * error)) break;
    error = now;
    if (error < worth && error < kWorthInAll * before) {
      kept = tried;
      worth = error;
    }
  }
  return kept;
}

void PriorRelaxation::relax(Estimate& estimate) const {
  if (!options_.enabled) return;
  Engine& engine = estimate.engine;
  const FactorGraph& graph = estimate.graph();
  const int newest = static_cast<int>(graph.states.size()) - 1;
  const int first = std::max(engine.first_state() + 1, newest - options_.intervals + 1);
  const std::vector<Vector6> densities(graph.qcs.begin() + first, graph.qcs.end());
  const std::vector<double> expansions(graph.expansions.begin() + first, graph.expansions.end());
  double tried = 1.0;
  const auto weaken = [&](double factor) {
    tried = factor;
    for (std::size_t i = 0; i < densities.size(); ++i) {
      engine.set_qc(first + static_cast<int>(i), factor * densities[i], expansions[i] / factor);
    }
    estimate.update();
    return newest_error(estimate);
  };
  const double most = options_.most / graph.qc.cwiseQuotient(qc_).maxCoeff();
  const double error = newest_error(estimate);
  if (!(error > options_.error)) return;
  estimate.count(Count::relaxations_tried);
  const double kept = worthwhile_relaxation(error, options_.error, most, weaken);
  if (kept != tried) weaken(kept);
  if (!(kept > 1.0)) return;
  engine.set_next_qc(graph.qcs.back());
  estimate.count(Count::priors_relaxed);
}

bool PriorRelaxation::is_relaxed(const Estimate& estimate) const {
  constexpr double kRecovered = 1.5;
  return estimate.graph().qc.cwiseQuotient(qc_).maxCoeff() > kRecovered;
}

void PriorRelaxation::recover(Estimate& estimate) const {
  const FactorGraph& graph = estimate.graph();
  const double dt = estimate.now() - graph.states[graph.states.size() - 2].t;
  estimate.engine.set_next_qc((std::exp(-dt / window_) * graph.qc).cwiseMax(qc_));
}

}  // namespace evbench::gp_map
