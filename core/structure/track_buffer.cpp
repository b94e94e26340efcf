#include "core/structure/track_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/support/median.hpp"

namespace evbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr auto by_time = [](const TrackObservation& a, const TrackObservation& b) { return a.t < b.t; };

/// A straight line through observations, its times relative to t.
struct Line {
  Vector2 at_t = Vector2::Zero(), slope = Vector2::Zero();

  Vector2 at(double dt) const { return at_t + slope * dt; }
};

/// The weighted least squares line; a constant when the times don't span one.
Line line_through(std::span<const TrackObservation> observations, std::span<const double> weights, double t) {
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

/// Robust line: reweighted by the distance from the coordinate-wise trend, so that single jumps of a tracker do no
/// harm.
Vector2 robust_line_at(std::span<const TrackObservation> observations, double t) {
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

}  // namespace

void TrackBuffer::add(std::span<const TrackObservation> observations) {
  for (const TrackObservation& z : observations) {
    if (removed(z.track) || !std::isfinite(z.t) || !z.pixel.allFinite()) continue;
    std::vector<TrackObservation>& track = tracks_[z.track];
    if (track.empty() || track.back().t <= z.t) {
      track.push_back(z);
    } else {
      track.insert(std::upper_bound(track.begin(), track.end(), z, by_time), z);
    }
  }
}

std::span<const TrackObservation> TrackBuffer::observations(TrackId track) const {
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

std::optional<Vector2> TrackBuffer::position(TrackId track, double t, double window) const {
  constexpr std::ptrdiff_t kEnough = 2;
  constexpr double kFarthest = 1.0;  // [s]
  const std::span<const TrackObservation> all = observations(track);
  TrackObservation bound;
  bound.t = t - 0.5 * window;
  auto begin = std::lower_bound(all.begin(), all.end(), bound, by_time);
  bound.t = t + 0.5 * window;
  auto end = std::upper_bound(begin, all.end(), bound, by_time);
  while (end - begin < kEnough) {
    const double before = begin == all.begin() ? kInfinity : t - (begin - 1)->t;
    const double after = end == all.end() ? kInfinity : end->t - t;
    if (std::min(before, after) > kFarthest) break;
    before < after ? --begin : ++end;
  }
  if (begin == end) return std::nullopt;
  const std::span<const TrackObservation> near(begin, end);
  const double span = near.back().t - near.front().t;
  if (span == 0.0 && near.front().t != t) return std::nullopt;
  const double beside =
      std::max(0.25 * window, span / static_cast<double>(std::max<std::ptrdiff_t>(end - begin - 1, 1)));
  if (near.front().t > t + beside || near.back().t < t - beside) return std::nullopt;
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
