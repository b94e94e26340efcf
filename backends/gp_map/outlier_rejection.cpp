#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "backends/gp_map/gp_map.hpp"
#include "backends/gp_map/track_errors.hpp"
#include "core/support/median.hpp"

// Outlier rejection and estimation of track noise, where the motion is known from both sides.
namespace evbench::gp_map {
namespace {

// While running, when less is known than at the end:
constexpr double kHasty = 2.0;             ///< factor of the final threshold
constexpr double kTrackNoiseChange = 1.5;  ///< factor by which a track's noise must change to be updated

using LandmarkErrors = std::vector<std::pair<int, TrackErrors>>;  ///< by landmark

/// Errors in `span` of the landmarks that have been seen after `seen` and not before `begun`.
LandmarkErrors errors_in(const FactorGraph& graph, const NoiseLearner& noise, const TimeSpan& span, double seen,
                         double begun) {
  const double usual = noise.scale_of_means();
  LandmarkErrors errors;
  for (int j = 0; j < static_cast<int>(graph.landmarks.size()); ++j) {
    const std::vector<int>& intervals = graph.landmarks[index(j)].intervals;
    if (intervals.empty() || graph.states[index(intervals.back())].t <= seen) continue;
    if (graph.states[index(intervals.front())].t <= begun) continue;
    errors.emplace_back(j, TrackErrors(graph, j, usual, span));
  }
  return errors;
}

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

}  // namespace

/// By the errors in this span: outliers are removed, and a drifted track keeps its landmark until it drifted.
void GpMap::reject_outliers(const NoiseLearner& noise, const TimeSpan& span) {
  LandmarkErrors errors = errors_in(graph(), noise, span, span.from, TimeSpan().from);
  std::erase_if(errors, [this](const auto& entry) { return is_reappearing(entry.first); });
  const double far = tail_of(errors) * options_.map.outlier_threshold;
  const double threshold = span.is_everything() ? far : kHasty * far;
  for (const int outlier : outliers(graph(), errors, threshold, span)) {
    const int first_seen = graph().landmarks[index(outlier)].intervals.front();
    if (graph().states[index(first_seen)].t > span.from) {
      become_outlier(outlier);
    } else {
      truncate_track(outlier, span.from);  // its earlier observations were accepted already
    }
  }
  for (const auto& [j, error] : errors) {
    const std::optional<double> from = error.drifts_from(threshold);
    if (from && graph().landmarks[index(j)].alive) truncate_track(j, *from);
  }
}

void GpMap::truncate_track(int landmark, double from) {
  map_->engine.remove_observations(landmark, from);
  end_track_of(landmark, Track::Role::drifted);
}

/// Gives each track seen since the beginning of this span its own noise, within the bounds of its leverage: tracks
/// differ by degrees, not only as outliers and inliers. All observations count, the newest too, because a drifting
/// track must soon count less. While running only recent tracks get new factors, which bounds how far back stages are
/// redone. If most would get a larger noise, the motion is wrong, and all keep theirs.
void GpMap::estimate_track_noise(const NoiseLearner& noise, const TimeSpan& span) {
  const bool running = !span.is_everything();
  const double begun = running ? graph().states.back().t - options_.learn.memory : TimeSpan().from;
  std::vector<std::pair<int, double>> own;
  std::vector<double> scales;
  for (const auto& [j, error] : errors_in(graph(), noise, {}, span.from, begun)) {
    own.emplace_back(j, error.sigma_scale());
    scales.push_back(own.back().second);
  }
  if (own.empty() || (running && median(std::move(scales)) > kTrackNoiseChange)) return;
  const double change = running ? kTrackNoiseChange : 1.0;
  for (const auto& [j, scale] : own) {
    MapEstimate::Known& known = map_->known[index(j)];
    if (scale < change * known.noise && scale > known.noise / change) continue;
    known.noise = scale;
    if (known.sigma_scale() != graph().landmarks[index(j)].sigma_scale)
      map_->engine.scale_sigmas(j, known.sigma_scale());
  }
}

}  // namespace evbench::gp_map
