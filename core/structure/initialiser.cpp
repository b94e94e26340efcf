#include "core/structure/initialiser.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/structure/depth_reversal.hpp"
#include "core/support/median.hpp"

namespace evbench {
namespace {

constexpr double kStationaryWindow = 10.0;  ///< [s] of the past in which even slow motion is visible
constexpr double kLead = 1.0;               ///< [s] from the first view to now during a stationary period

double median_depth(const TwoViewCandidate& candidate) {
  std::vector<double> depths;
  for (std::size_t i = 0; i < candidate.points.size(); ++i) {
    if (candidate.inlier[i]) depths.push_back(candidate.points[i].z());
  }
  return median(std::move(depths));
}

std::string counted(std::size_t tracks) { return fmt::format("{} track{}", tracks, tracks == 1 ? "" : "s"); }

InitialGuess to_guess(const TwoViewCandidate& candidate, const TrackMatches& matches) {
  const double depth = median_depth(candidate);
  InitialGuess guess;
  guess.t0 = matches.t0;
  guess.t1 = matches.t1;
  guess.T1 = {candidate.T_first_second.q, candidate.T_first_second.p / depth};
  guess.median_parallax_deg = candidate.median_parallax_deg;
  for (std::size_t i = 0; i < matches.tracks.size(); ++i) {
    if (candidate.inlier[i]) {
      guess.landmarks.push_back({matches.tracks[i], candidate.points[i] / depth});
    } else {
      guess.outliers.push_back(matches.tracks[i]);
    }
  }
  return guess;
}

}  // namespace

TrackMatches matches_between(const TrackBuffer& buffer, double t0, double t1, const PlaceWindow& window) {
  TrackMatches result;
  result.t0 = t0;
  result.t1 = t1;
  result.or_nearest = window.or_nearest;
  for (const TrackId id : buffer.ids()) {
    const std::optional<Vector2> second = buffer.position(id, t1, window);
    const std::optional<Vector2> first = second ? buffer.position(id, t0, window) : std::nullopt;
    if (!first) continue;
    result.tracks.push_back(id);
    result.first.push_back(*first);
    result.second.push_back(*second);
  }
  return result;
}

void InitialiserOptions::declare(OptionSet& set) {
  set.add("min_tracks", min_tracks, "tracks seen in both views").range(8);
  set.add("window", window, "time over which a track's observations give its place in a view [s]").above(0.0);
  set.group("two_view", two_view, "relative pose of the two views");
}

double TrackMatches::median_motion() const {
  std::vector<double> motions;
  for (std::size_t i = 0; i < tracks.size(); ++i) motions.push_back((second[i] - first[i]).norm());
  return median(std::move(motions));
}

Initialiser::Attempt Initialiser::attempt(const TrackBuffer& tracks, double t) {
  const TrackMatches matches = match(tracks, t);
  return matches.reason.empty() ? solve(matches) : Attempt{matches.reason, {}};
}

TrackMatches Initialiser::match(const TrackBuffer& tracks, double t) {
  skip_stationary_period(tracks, t);
  TrackMatches now;
  std::size_t common = 0;
  for (const bool or_nearest : {false, true}) {
    const PlaceWindow window(options_.window, or_nearest);
    TrackMatches matches;
    if (reference_) matches = matches_between(tracks, *reference_, t, window);
    if (are_enough(matches)) return matches;
    common = std::max(common, matches.tracks.size());
    if (!are_enough(now)) now = matches_between(tracks, t, t, window);
  }
  TrackMatches none;
  if (reference_) {
    none.reason = fmt::format("{} common to the views at {:.3f} s and {:.3f} s, {} needed; ", counted(common),
                              *reference_, t, options_.min_tracks);
  }
  reference_ = are_enough(now) ? std::optional(t) : std::nullopt;
  none.reason += reference_ ? fmt::format("first view set at {:.3f} s with {}", t, counted(now.tracks.size()))
                            : fmt::format("{} observed around {:.3f} s, {} needed for a first view",
                                          counted(now.tracks.size()), t, options_.min_tracks);
  return none;
}

/// If nothing has moved for a while, sets the first view to a short time ago.
void Initialiser::skip_stationary_period(const TrackBuffer& tracks, double t) {
  if (!reference_ || t - *reference_ < kLead) return;
  const double known = t - 0.5 * options_.window;  // until then windows have observations on both sides
  TrackMatches before = matches_between(tracks, t - kStationaryWindow, known, options_.window);
  if (!are_enough(before)) before = matches_between(tracks, t - kStationaryWindow, known, {options_.window, true});
  if (!are_enough(before)) return;
  if (before.median_motion() < options_.two_view.threshold_px) reference_ = t - kLead;
}

Initialiser::Attempt Initialiser::solve(const TrackMatches& matches) const {
  const TwoViewResult result = relative_pose(matches.first, matches.second, camera_, options_.two_view);
  Attempt attempt{result.reason, {}};
  for (const TwoViewCandidate& candidate : result.candidates) {
    attempt.candidates.push_back(to_guess(candidate, matches));
    attempt.candidates.push_back(reverse_depth(attempt.candidates.back()));
  }
  return attempt;
}

}  // namespace evbench
