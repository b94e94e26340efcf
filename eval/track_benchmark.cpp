#include "eval/track_benchmark.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr int kThresholds = 31;  // [px]: 1, 2, ...

using Track = std::vector<TrackObservation>;

std::map<TrackId, Track> by_id(std::span<const TrackObservation> observations) {
  std::map<TrackId, Track> tracks;
  for (const TrackObservation& z : observations) tracks[z.track].push_back(z);
  return tracks;
}

/// The place of a track at a time, on the straight line between its observations or beyond them.
Vector2 place_at(const Track& track, double t) {
  if (track.size() == 1) return track.front().pixel;
  auto right = std::ranges::lower_bound(track, t, {}, &TrackObservation::t);
  right = std::clamp(right, track.begin() + 1, track.end() - 1);
  const auto left = right - 1;
  return left->pixel + (t - left->t) / (right->t - left->t) * (right->pixel - left->pixel);
}

/// A true track and the errors of the track that follows it.
struct Followed {
  std::vector<double> times;   ///< [s] of the true observations
  std::vector<double> errors;  ///< [px] at the true observations behind the first
  double end;                  ///< [s] of the track's last observation
};

/// Cut to the track's time where this protocol does so; none if fewer than two true observations are left.
std::optional<Followed> follow(const Track& truth, const Track& track, TrackProtocol protocol) {
  const bool cut = protocol == TrackProtocol::cropped && truth.back().t > track.back().t;
  Followed followed{{}, {}, track.back().t};
  for (const TrackObservation& z : truth) {
    if (cut && (z.t < track.front().t || z.t > track.back().t)) continue;
    if (!followed.times.empty()) followed.errors.push_back((z.pixel - place_at(track, z.t)).norm());
    followed.times.push_back(z.t);
  }
  return followed.times.size() < 2 ? std::nullopt : std::optional(followed);
}

/// Relative age, and the number of errors until then.
struct RelativeAge {
  double value = 0.0;
  std::size_t errors = 0;
};

RelativeAge full_age(const Followed& followed, double threshold) {
  std::size_t good = 0;
  while (good < followed.errors.size() && followed.errors[good] <= threshold &&
         followed.times[good + 1] <= followed.end) {
    ++good;
  }
  return {(followed.times[good] - followed.times.front()) / (followed.times.back() - followed.times.front()), good};
}

RelativeAge cropped_age(const Followed& followed, double threshold) {
  const auto far = std::ranges::find_if(followed.errors, [&](double error) { return error > threshold; });
  if (far == followed.errors.end()) return {1.0, followed.errors.size()};
  const auto first_far = static_cast<std::size_t>(far - followed.errors.begin());
  if (first_far <= 1) return {};
  const double reached = followed.times[first_far - 1] - followed.times.front();
  return {reached / (followed.times.back() - followed.times.front()), first_far};
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

}  // namespace

TrackBenchmark benchmark_tracks(std::span<const TrackObservation> truth, std::span<const TrackObservation> tracks,
                                TrackProtocol protocol) {
  const std::map<TrackId, Track> true_tracks = by_id(truth), found = by_id(tracks);
  std::vector<Followed> all;
  std::size_t without = 0;  // true tracks that nothing follows
  for (const auto& [id, true_track] : true_tracks) {
    const auto track = found.find(id);
    if (track == found.end()) {
      without += true_track.size() > 1 ? 1 : 0;
    } else if (auto followed = follow(true_track, track->second, protocol)) {
      all.push_back(std::move(*followed));
    }
  }
  if (all.empty()) throw InputError("no track has the id of a true one; expected ids as in the ground truth");
  TrackBenchmark result;
  result.tracks = all.size() + (protocol == TrackProtocol::full ? without : 0);
  std::vector<double> inliers, ages, expected;
  for (int threshold = 1; threshold <= kThresholds; ++threshold) {
    std::vector<double> not_zero, errors;
    for (const Followed& followed : all) {
      const RelativeAge age =
          protocol == TrackProtocol::full ? full_age(followed, threshold) : cropped_age(followed, threshold);
      if (age.value == 0.0) continue;
      not_zero.push_back(age.value);
      // As published, the first of these errors does not count.
      const auto begin = followed.errors.begin() + (protocol == TrackProtocol::cropped ? 1 : 0);
      errors.push_back(mean_of(
          {std::min(begin, followed.errors.end()), followed.errors.begin() + static_cast<std::ptrdiff_t>(age.errors)}));
    }
    inliers.push_back(static_cast<double>(not_zero.size()) / static_cast<double>(result.tracks));
    ages.push_back(mean_of(not_zero));
    expected.push_back(inliers.back() * ages.back());
    if (threshold != 5) continue;
    result.age_5px = ages.back();
    result.error_5px = mean_of(errors);
  }
  result.expected_age = mean_of(expected);
  result.inlier_ratio = mean_of(inliers);
  result.age = mean_of(ages);
  return result;
}

}  // namespace evbench
