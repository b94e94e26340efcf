#include "core/structure/track_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/support/median.hpp"

namespace evbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr auto by_time = [](const UndistortedObservation& a, const UndistortedObservation& b) { return a.t < b.t; };

/// A straight line through observations, with times relative to t.
struct Line {
  Vector2 at_t = Vector2::Zero(), slope = Vector2::Zero();

  Vector2 at(double dt) const { return at_t + slope * dt; }
};

/// The weighted least-squares line; constant if all times are equal.
Line line_through(std::span<const UndistortedObservation> observations, std::span<const double> weights, double t) {
  double sum = 0.0, time = 0.0;
  Vector2 mean = Vector2::Zero();
  for (std::size_t i = 0; i < observations.size(); ++i) {
    sum += weights[i];
    time += weights[i] * (observations[i].t - t);
    mean += weights[i] * observations[i].pixel;
  }
  time /= sum;
  mean /= sum;
  double spread = 0.0;
  Vector2 slope = Vector2::Zero();
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const double dt = observations[i].t - t - time;
    spread += weights[i] * dt * dt;
    slope += weights[i] * dt * (observations[i].pixel - mean);
  }
  if (!(spread > 0.0)) return {mean, Vector2::Zero()};
  slope /= spread;
  return {mean - slope * time, slope};
}

/// Robust line fit: iteratively reweighted by the distances from the line, against single jumps of a tracker.
Vector2 robust_line_at(std::span<const UndistortedObservation> observations, double t) {
  std::vector<double> weights(observations.size(), 1.0);
  Line line = line_through(observations, weights, t);
  if (observations.size() < 4) return line.at_t;
  std::vector<double> distances(observations.size());
  for (int iteration = 0; iteration < 3; ++iteration) {
    for (std::size_t i = 0; i < observations.size(); ++i) {
      distances[i] = (observations[i].pixel - line.at(observations[i].t - t)).norm();
    }
    const double width = std::max(2.0 * median(distances), 1e-3);
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = distances[i] <= width ? 1.0 : width / distances[i];
    line = line_through(observations, weights, t);
  }
  return line.at_t;
}

std::span<const UndistortedObservation> within(std::span<const UndistortedObservation> all, double from, double to) {
  UndistortedObservation bound;
  bound.t = from;
  const auto begin = std::lower_bound(all.begin(), all.end(), bound, by_time);
  bound.t = to;
  return {begin, std::upper_bound(begin, all.end(), bound, by_time)};
}

/// The two observations nearest to t, for slowly observed tracks. Empty if the gap between them is far longer than
/// those around them.
std::span<const UndistortedObservation> nearest_two(std::span<const UndistortedObservation> all, double t) {
  constexpr double kFarthest = 1.0;  // [s]
  constexpr double kUnusual = 4.0;
  constexpr std::ptrdiff_t kNeighbours = 2;
  UndistortedObservation bound;
  bound.t = t;
  auto begin = std::lower_bound(all.begin(), all.end(), bound, by_time), end = begin;
  while (end - begin < 2) {
    const double before = begin == all.begin() ? kInfinity : t - (begin - 1)->t;
    const double after = end == all.end() ? kInfinity : end->t - t;
    if (std::min(before, after) > kFarthest) return {};
    before < after ? --begin : ++end;
  }
  const auto first = begin - std::min(kNeighbours, begin - all.begin()),
             last = end + std::min(kNeighbours, all.end() - end);
  const double between = (end - 1)->t - begin->t, rest = (last - 1)->t - first->t - between;
  const auto steps = static_cast<double>(last - first - 2);
  return between * steps <= kUnusual * rest ? std::span(begin, end) : std::span<const UndistortedObservation>();
}

}  // namespace

void TrackBuffer::add(std::span<const UndistortedObservation> observations) {
  for (const UndistortedObservation& z : observations) {
    if (removed(z.track) || !std::isfinite(z.t) || !z.pixel.allFinite()) continue;
    std::vector<UndistortedObservation>& track = tracks_[z.track];
    if (track.empty() || track.back().t <= z.t) {
      track.push_back(z);
    } else {
      track.insert(std::upper_bound(track.begin(), track.end(), z, by_time), z);
    }
  }
}

std::span<const UndistortedObservation> TrackBuffer::observations(TrackId track) const {
  const auto found = tracks_.find(track);
  if (found == tracks_.end()) return {};
  return found->second;
}

std::vector<TrackId> TrackBuffer::ids() const {
  std::vector<TrackId> result;
  result.reserve(tracks_.size());
  for (const auto& [id, track] : tracks_) result.push_back(id);
  return result;
}

std::vector<TrackId> TrackBuffer::alive(double t, double margin) const {
  std::vector<TrackId> result;
  for (const auto& [id, track] : tracks_) {
    if (track.front().t - margin <= t && t <= track.back().t + margin) result.push_back(id);
  }
  return result;
}

std::optional<Vector2> TrackBuffer::position(TrackId track, double t, const PlaceWindow& window) const {
  const std::span<const UndistortedObservation> all = observations(track);
  std::span<const UndistortedObservation> near = within(all, t - 0.5 * window.length, t + 0.5 * window.length);
  double margin = 0.25 * window.length;
  if (window.or_nearest && near.size() < 2) {
    if (const auto pair = nearest_two(all, t); pair.size() == 2) {
      near = pair;
      margin = std::max(margin, pair.back().t - pair.front().t);
    }
  }
  if (near.empty()) return std::nullopt;
  if (near.front().t == near.back().t && near.front().t != t) return std::nullopt;
  if (near.front().t > t + margin || near.back().t < t - margin) return std::nullopt;
  return robust_line_at(near, t);
}

void TrackBuffer::forget_ended_before(double t) {
  std::erase_if(tracks_, [t](const auto& track) { return track.second.back().t < t; });
}

void TrackBuffer::remove(TrackId track) {
  tracks_.erase(track);
  removed_.insert(track);
}

}  // namespace evbench
