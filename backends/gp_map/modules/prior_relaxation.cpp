#include "backends/gp_map/modules/prior_relaxation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/smoother/factors.hpp"
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
  const GpInterval interval = graph.interval(static_cast<int>(k));
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
  set.add("factor", factor, "by how much weaker it becomes in one step").range(1.0, 1e6);
  set.add("gain", gain, "it stays weaker if the error falls below this share").range(0.0, 1.0);
  set.add("most", most, "times weaker than the given prior, at most, after several steps").range(1.0, 1e12);
  set.add("intervals", intervals, "newest intervals of the motion that are relaxed").range(1, 100);
}

void PriorRelaxation::relax(Estimate& estimate) const {
  if (!options_.enabled) return;
  Smoother& smoother = estimate.smoother;
  const FactorGraph& graph = estimate.graph();
  const double error = newest_error(estimate), relaxed = graph.qc.cwiseQuotient(qc_).maxCoeff();
  if (!(error > options_.error) || relaxed * options_.factor > options_.most) return;
  const int newest = static_cast<int>(graph.states.size()) - 1;
  const int first = std::max(smoother.first_state() + 1, newest - options_.intervals + 1);
  const std::vector<Vector6> densities(graph.qcs.begin() + first, graph.qcs.end());
  const std::vector<double> expansions(graph.expansions.begin() + first, graph.expansions.end());
  const auto weaken = [&](double factor) {
    for (std::size_t i = 0; i < densities.size(); ++i) {
      smoother.set_qc(first + static_cast<int>(i), factor * densities[i], expansions[i] / factor);
    }
    estimate.update();
  };
  estimate.count(Count::relaxations_tried);
  weaken(options_.factor);
  if (newest_error(estimate) < options_.gain * error) {
    smoother.set_next_qc(graph.qcs.back());
    estimate.count(Count::priors_relaxed);
  } else {
    weaken(1.0);
  }
}

bool PriorRelaxation::is_relaxed(const Estimate& estimate) const {
  constexpr double kRecovered = 1.5;
  return estimate.graph().qc.cwiseQuotient(qc_).maxCoeff() > kRecovered;
}

void PriorRelaxation::recover(Estimate& estimate) const {
  const FactorGraph& graph = estimate.graph();
  const double dt = estimate.now() - graph.states[graph.states.size() - 2].t;
  estimate.smoother.set_next_qc((std::exp(-dt / window_) * graph.qc).cwiseMax(qc_));
}

}  // namespace evbench::gp_map
