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

// What tracks turn out to be worth, once it is known from both sides where the camera was.
namespace evbench::gp_map {
namespace {

// While running, when less is known than in the end:
constexpr double kHasty = 2.0;             ///< times farther off than in the end is what goes
constexpr double kTrackNoiseChange = 1.5;  ///< by which a track's noise must change to be set anew

using JudgedTrack = std::vector<std::pair<int, TrackErrors>>;  ///< by landmark

/// In `span`, of the landmarks that have been seen after `seen` and were not before `begun`.
JudgedTrack errors_in(const FactorGraph& graph, const NoiseLearner& noise, const TimeSpan& span, double seen, double begun) {
  const double usual = noise.scale_of_means();
  JudgedTrack errors;
  for (int j = 0; j < static_cast<int>(graph.landmarks.size()); ++j) {
    const std::vector<int>& intervals = graph.landmarks[index(j)].intervals;
    if (intervals.empty() || graph.states[index(intervals.back())].t <= seen) continue;
    if (graph.states[index(intervals.front())].t <= begun) continue;
    errors.emplace_back(j, TrackErrors(graph, j, usual, span));
  }
  return errors;
}

/// How much farther the means of all tracks reach than normally distributed ones of their scale: the errors of trackers
/// have longer tails, and what would be far off otherwise is not for them. By a quantile beyond which all outliers are,
/// as they are few; where they are many, it must not hide them.
double tail_of(const JudgedTrack& errors) {
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

/// Landmarks of which the track says something else in this span. One that was good before it slid off is none, however
/// long ago that was: without what follows its landmark will fit, or it goes the next time. Where most of the tracks
/// that are seen together are far off, it is the motion that is wrong, and none of them.
std::vector<int> outliers(const FactorGraph& graph, const JudgedTrack& errors, double threshold, const TimeSpan& span) {
  const auto seen = [&](int j) {
    std::vector<int> intervals;
    std::ranges::copy_if(graph.landmarks[index(j)].intervals, std::back_inserter(intervals),
                         [&](int k) { return span.meets(graph.states[index(k - 1)].t, graph.states[index(k)].t); });
    return intervals;
  };
  std::vector<int> far;
  std::map<int, std::pair<int, int>> far_of;  // by interval: of so many that are seen in it so many are far off
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

/// By what they show in this span: outliers go, and a track that slid keeps its landmark up to there.
void GpMap::reject_outliers(const NoiseLearner& noise, const TimeSpan& span) {
  const JudgedTrack errors = errors_in(graph(), noise, span, span.from, TimeSpan().from);
  const double far = tail_of(errors) * options_.map.outlier_threshold;
  const double threshold = span.is_everything() ? far : kHasty * far;
  for (const int outlier : outliers(graph(), errors, threshold, span)) {
    const int first_seen = graph().landmarks[index(outlier)].intervals.front();
    if (graph().states[index(first_seen)].t > span.from) {
      become_outlier(outlier);
    } else {
      has_drifted(outlier, span.from);  // what it was before has been judged already
    }
  }
  for (const auto& [j, error] : errors) {
    const std::optional<double> from = error.drifts_from(threshold);
    if (from && graph().landmarks[index(j)].alive) has_drifted(j, *from);
  }
}

void GpMap::has_drifted(int landmark, double from) {
  map_->engine.remove_observations(landmark, from);
  end_track_of(landmark, Track::Role::slid);
}

/// Each track that has been seen since this span began counts with its own noise, within the bounds of its leverage:
/// whether it is an outlier is not a question of yes or no. All that it has shown tells, the newest too, as a sliding
/// track must soon count less. While running only young tracks are weighed, which bounds how far back stages are
/// redone; and where most would count for less, it is the motion that is wrong, and all keep what they have.
void GpMap::weigh_tracks(const NoiseLearner& noise, const TimeSpan& span) {
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
