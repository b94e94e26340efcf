#include "backends/gp_map/modules/outlier_rejection.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include "backends/gp_map/modules/track_errors.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {
namespace {

/// How much longer the tail of all tracks' means is than that of a normal distribution of the same scale. Errors of
/// trackers have longer tails, and the threshold follows them. The tail is measured at a quantile below all outliers as
/// long as these are few, and it is limited, so that many outliers are not hidden.
double tail_of(const LandmarkErrors& errors) {
  constexpr double kShare = 0.7, kLongest = 2.0;
  std::vector<double> squares;
  for (const auto& [j, error] : errors) {
    for (const double square : error.squares()) {
      if (std::isfinite(square)) squares.push_back(square);
    }
  }
  if (squares.empty()) return 1.0;
  const double normal = -2.0 * std::log(1.0 - kShare);
  return std::clamp(std::sqrt(order_statistic(std::move(squares), kShare) / normal), 1.0, kLongest);
}

/// Landmarks whose tracks show something else in this span. A track that was good before it drifted is no outlier,
/// however long ago that was: without the drifted part its landmark will fit, or it is rejected the next time. If most
/// tracks that are seen together have large errors, the motion is wrong, and none of them is an outlier.
std::vector<int> outliers(const FactorGraph& graph, const LandmarkErrors& errors, double threshold,
                          const TimeSpan& span) {
  const auto seen = [&](int j) {
    std::vector<int> intervals;
    std::ranges::copy_if(graph.landmarks[index(j)].intervals, std::back_inserter(intervals),
                         [&](int k) { return span.overlaps(graph.states[index(k - 1)].t, graph.states[index(k)].t); });
    return intervals;
  };
  std::vector<int> far;
  std::map<int, std::pair<int, int>> far_of;  // by interval: tracks with large errors, and all tracks
  for (const auto& [j, error] : errors) {
    const bool is_far = error.is_outlier(threshold);
    if (is_far && !error.drifts_from(threshold)) far.push_back(j);
    for (const int k : seen(j)) {
      ++far_of[k].second;
      if (is_far) ++far_of[k].first;
    }
  }
  std::erase_if(far, [&](int j) {
    int wrong = 0, all = 0;
    for (const int k : seen(j)) {
      ++all;
      if (2 * far_of.at(k).first > far_of.at(k).second) ++wrong;
    }
    return 2 * wrong > all;
  });
  return far;
}

void remove(Estimate& estimate, TrackTable& tracks, int landmark) {
  estimate.remove_landmark(landmark);
  tracks.end_track_of(landmark, TrackTable::Role::outlier);
  estimate.count(Count::outliers);
}

void truncate(Estimate& estimate, TrackTable& tracks, int landmark, double from) {
  estimate.smoother.remove_observations(landmark, from);
  tracks.end_track_of(landmark, TrackTable::Role::drifted);
  estimate.count(Count::truncated);
}

}  // namespace

void OutlierOptions::declare(OptionSet& set) {
  set.add("enabled", enabled, "tracks with large errors are rejected, drifting ones from where they drift");
  set.add("threshold", threshold,
          "tracks whose mean reprojection error over all their observations is larger are rejected; the final estimate "
          "truncates a track from where its error, averaged over 0.15 s, stays larger [sigmas of such means, larger "
          "where trackers drift; of those over 0.15 s, larger still where their errors have longer tails than normal "
          "ones]")
      .above(0.0);
  set.add("running", running, "factor of the threshold of averages while running, when less is known than at the end")
      .above(0.0);
}

void OutlierRejection::reject_newest(Estimate& estimate, TrackTable& tracks) const {
  if (!options_.enabled) return;
  std::vector<int> outliers;
  const auto& groups = estimate.graph().intervals.back().groups();
  for (const auto& group : groups) {  // whether a re-acquired track shows its landmark is re-association's to say
    if (!tracks.is_reappearing(group.landmark) && is_outlier(estimate, group.landmark))
      outliers.push_back(group.landmark);
  }
  if (2 * outliers.size() > groups.size()) return;  // most tracks are outliers: the motion is wrong
  for (const int landmark : outliers) remove(estimate, tracks, landmark);
}

void OutlierRejection::reject_since(int first, Estimate& estimate, TrackTable& tracks) const {
  if (!options_.enabled) return;
  for (int j = first; j < std::ssize(estimate.graph().landmarks); ++j) {
    if (is_outlier(estimate, j)) remove(estimate, tracks, j);
  }
}

bool OutlierRejection::is_outlier(Estimate& estimate, int landmark) const {
  const FactorGraph& graph = estimate.graph();
  const FactorGraph::Landmark& l = graph.landmarks[index(landmark)];
  if (l.intervals.empty()) return false;
  const Observation& last = graph.intervals[index(l.intervals.back())].of(landmark).back();
  const double inverse_sigma = l.sigma_scale * last.whitening.inverse_sigma();  // as given
  const double far = options_.threshold * estimate.noise.scale_of_means();
  return inverse_sigma * estimate.smoother.reprojection_mean(landmark) > far;
}

void OutlierRejection::reject_smoothed(Estimate& estimate, TrackTable& tracks, const TimeSpan& span) const {
  if (!options_.enabled) return;
  const FactorGraph& graph = estimate.graph();
  LandmarkErrors errors = errors_of_landmarks(graph, estimate.noise, span, span.from, TimeSpan().from);
  std::erase_if(errors, [&](const auto& entry) { return tracks.is_reappearing(entry.first); });
  const double far = tail_of(errors) * options_.threshold;
  const double threshold = span.is_everything() ? far : options_.running * far;
  for (const int outlier : outliers(graph, errors, threshold, span)) {
    const int first_seen = graph.landmarks[index(outlier)].intervals.front();
    if (graph.states[index(first_seen)].t > span.from) {
      remove(estimate, tracks, outlier);
    } else {
      truncate(estimate, tracks, outlier, span.from);  // its earlier observations were accepted already
    }
  }
  for (const auto& [j, error] : errors) {
    const std::optional<double> from = error.drifts_from(threshold);
    if (from && graph.landmarks[index(j)].alive) truncate(estimate, tracks, j, *from);
  }
}

}  // namespace evbench::gp_map
