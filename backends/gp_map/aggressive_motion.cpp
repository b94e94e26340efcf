#include "backends/gp_map/aggressive_motion.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "backends/gp_map/factors.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {
namespace {

constexpr double kFar = 3.0;  ///< [sigmas] newest_error() above this means that the estimate has not converged

}  // namespace

double worthwhile_relaxation(double error, double most, const std::function<double(double)>& error_at) {
  constexpr double kWeaker = 10.0;  // per attempt
  constexpr double kHelp = 0.95;    // attempts go on while the error falls below this share of the last one
  constexpr double kWorthInAll = 0.8, kWorthEach = 0.9;  // remaining share: in all; per attempt since the last one kept
  const double before = error;
  double worth = error, kept = 1.0;
  for (double tried = 1.0; error > kFar && tried < most;) {
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

void AggressiveMotion::converge(Engine& engine, const NoiseLearner& noise, UpdateSummary& update) const {
  constexpr double kHelp = 0.95;
  constexpr int kSteps = 6;
  double error = newest_error(engine.graph(), noise);
  for (int i = 0; i < kSteps && error > kFar && update.damping > 0.0; ++i) {
    update = engine.update();
    const double now = newest_error(engine.graph(), noise);
    if (!(now < kHelp * error)) return;
    error = now;
  }
}

void AggressiveMotion::relax_prior(Engine& engine, const NoiseLearner& noise, UpdateSummary& update) const {
  constexpr double kWeakest = 1e4;  // relative to the given prior
  constexpr int kIntervals = 3;
  const FactorGraph& graph = engine.graph();
  const int newest = static_cast<int>(graph.states.size()) - 1;
  const int first = std::max(engine.first_state() + 1, newest - kIntervals + 1);
  const std::vector<Vector6> densities(graph.qcs.begin() + first, graph.qcs.end());
  const std::vector<double> expansions(graph.expansions.begin() + first, graph.expansions.end());
  double tried = 1.0;
  const auto weaken = [&](double factor) {
    tried = factor;
    for (std::size_t i = 0; i < densities.size(); ++i) {
      engine.set_qc(first + static_cast<int>(i), factor * densities[i], expansions[i] / factor);
    }
    update = engine.update();
    return newest_error(engine.graph(), noise);
  };
  const double most = kWeakest / graph.qc.cwiseQuotient(qc_).maxCoeff();
  const double kept = worthwhile_relaxation(newest_error(graph, noise), most, weaken);
  if (kept != tried) weaken(kept);
  if (kept > 1.0) engine.set_next_qc(graph.qcs.back());
}

bool AggressiveMotion::is_prior_relaxed(const FactorGraph& graph) const {
  constexpr double kRecovered = 1.5;
  return graph.qc.cwiseQuotient(qc_).maxCoeff() > kRecovered;
}

void AggressiveMotion::recover(Engine& engine) const {
  const FactorGraph& graph = engine.graph();
  const double dt = graph.states.back().t - graph.states[graph.states.size() - 2].t;
  engine.set_next_qc((std::exp(-dt / window_) * graph.qc).cwiseMax(qc_));
}

/// Median error of the tracks seen in the newest interval, each at its last observation; 0: too few tracks. Unit: the
/// sigma of a track's mean error, as for the rejection of outliers, because trackers drift and this is no motion; but
/// at most a few pixel sigmas, because many tracks do not drift in common by chance.
double AggressiveMotion::newest_error(const FactorGraph& graph, const NoiseLearner& noise) const {
  constexpr double kMostDrift = 3.0;
  const std::size_t k = graph.states.size() - 1;
  const GpInterval interval(graph.states[k - 1], graph.states[k]);
  const double scale = std::min(kMostDrift * noise.scale(), noise.scale_of_means());
  std::vector<double> errors;
  for (const auto& group : graph.intervals[k].groups()) {
    const Observation& z = graph.intervals[k].of(group).back();
    const Vector3& position = graph.landmarks[index(group.landmark)].position;
    errors.push_back(reprojection_residual(interval, position, z, graph.camera).norm() / scale);
  }
  return std::ssize(errors) < min_landmarks_ ? 0.0 : median(std::move(errors));
}

}  // namespace evbench::gp_map
