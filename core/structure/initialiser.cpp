#include "core/structure/initialiser.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/structure/depth_reversal.hpp"
#include "core/support/median.hpp"

namespace evbench {
namespace {

/// Tracks with a place at both times, and the places.
struct Matches {
  std::vector<TrackId> tracks;
  std::vector<Vector2> first, second;
};

Matches match(const TrackBuffer& buffer, double t0, double t1, double window) {
  Matches result;
  for (const TrackId id : buffer.alive(t1, 0.5 * window)) {
    const std::optional<Vector2> first = buffer.position(id, t0, window), second = buffer.position(id, t1, window);
    if (!first || !second) continue;
    result.tracks.push_back(id);
    result.first.push_back(*first);
    result.second.push_back(*second);
  }
  return result;
}

double median_depth(const TwoViewCandidate& candidate) {
  std::vector<double> depths;
  for (std::size_t i = 0; i < candidate.points.size(); ++i) {
    if (candidate.inlier[i]) depths.push_back(candidate.points[i].z());
  }
  return median(std::move(depths));
}

InitialGuess to_guess(const TwoViewCandidate& candidate, const std::vector<TrackId>& tracks, double t0, double t1) {
  const double depth = median_depth(candidate);
  InitialGuess guess;
  guess.t0 = t0;
  guess.t1 = t1;
  guess.T1 = {candidate.T_first_second.q, candidate.T_first_second.p / depth};
  guess.median_parallax_deg = candidate.median_parallax_deg;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (candidate.inlier[i]) {
      guess.landmarks.push_back({tracks[i], candidate.points[i] / depth});
    } else {
      guess.outliers.push_back(tracks[i]);
    }
  }
  return guess;
}

}  // namespace

void InitialiserOptions::declare(OptionSet& set) {
  set.add("min_tracks", min_tracks, "tracks seen in both views").range(8);
  set.add("window", window, "time over which a track's observations give its place in a view [s]").above(0.0);
  set.group("two_view", two_view, "relative pose of the two views");
}

Initialiser::Attempt Initialiser::attempt(const TrackBuffer& tracks, double t) {
  Matches matches;
  if (reference_) matches = match(tracks, *reference_, t, options_.window);
  if (static_cast<int>(matches.tracks.size()) < options_.min_tracks) {
    const std::size_t now = match(tracks, t, t, options_.window).tracks.size();
    const bool enough = static_cast<int>(now) >= options_.min_tracks;
    const std::string reason = enough ? fmt::format("first view set at {:.3f} s with {} tracks", t, now)
                                      : fmt::format("{} tracks at {:.3f} s, {} needed", now, t, options_.min_tracks);
    reference_ = enough ? std::optional(t) : std::nullopt;
    return {reason, {}};
  }
  const TwoViewResult result = relative_pose(matches.first, matches.second, camera_, options_.two_view);
  Attempt attempt{result.reason, {}};
  for (const TwoViewCandidate& candidate : result.candidates) {
    attempt.candidates.push_back(to_guess(candidate, matches.tracks, *reference_, t));
    attempt.candidates.push_back(reverse_depth(attempt.candidates.back()));
  }
  return attempt;
}

}  // namespace evbench
