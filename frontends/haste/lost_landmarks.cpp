#include "frontends/haste/lost_landmarks.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "core/events/event_time.hpp"
#include "frontends/haste/displacement.hpp"
#include "frontends/haste/recognition.hpp"
#include "frontends/haste/tracking/alignment.hpp"

namespace evbench::haste {
namespace {

/// [s] The time of a tracker's window is that of its middle event.
double middle_of(std::span<const Event> window) { return seconds(window[window.size() / 2].t); }

}  // namespace

void LostLandmarks::remember(TrackId track, double t, const Template& look, double angle, const Guidance& guidance) {
  if (!(look.mass() > 0.0)) return;
  lost_.insert_or_assign(track, Lost{t, t, look, angle, guidance.pose(t), guidance.world()});
}

void LostLandmarks::forget_before(double t) {
  std::erase_if(lost_, [&](const auto& entry) { return entry.second.t < t; });
}

void LostLandmarks::disappoint(TrackId track, double t) {
  constexpr double kPause = 0.5;  // [s]
  if (const auto lost = lost_.find(track); lost != lost_.end()) lost->second.tried = t + kPause;
}

std::vector<LostLandmarks::Candidate> LostLandmarks::expected_in_view(const Guidance& guidance, double t,
                                                                      const Tracked& tracked,
                                                                      const Camera& camera) const {
  std::vector<Candidate> result;
  for (const auto& [track, lost] : lost_) {
    if (lost.world != guidance.world() || tracked.has(track)) continue;
    const std::optional<Guidance::Prediction> expected = guidance.predict(track, t);
    if (expected && camera.contains(expected->pixel, kPatchRadius)) {
      result.push_back({track, expected->pixel, lost.tried});
    }
  }
  return result;
}

/// The landmark with its expected template; its position is not set yet.
LostLandmarks::Found LostLandmarks::as_expected(TrackId track, const Lost& lost, const Guidance& guidance,
                                                double t) const {
  const AppearanceChange change = appearance_change(lost.T_world_camera, guidance.pose(t), *guidance.position(track));
  return {track, {}, lost.look.warped(lost.angle + change.angle, change.scale)};
}

std::vector<LostLandmarks::Found> LostLandmarks::find(const Guidance& guidance, double t, const RecentEvents& recent,
                                                      const Tracked& tracked, double distance, const Camera& camera) {
  constexpr std::size_t kAtATime = 4;  // a search costs as much as thousands of events
  constexpr double kPause = 0.02;      // [s] between two searches for one
  std::vector<Found> result;
  if (!guidance.available() || recent.events().empty()) return result;
  forget_before(t - options_.memory);

  std::vector<Candidate> candidates = expected_in_view(guidance, t, tracked, camera);
  std::erase_if(candidates, [&](const Candidate& candidate) {
    const auto is_near = [&](const Vector2& p) { return (p - candidate.expected).norm() < distance; };
    return t - candidate.tried < kPause || std::ranges::any_of(tracked.places, is_near);
  });
  std::ranges::stable_sort(candidates, {}, &Candidate::tried);
  if (candidates.size() > kAtATime) candidates.resize(kAtATime);
  for (const Candidate& candidate : candidates) {
    Lost& lost = lost_.at(candidate.track);
    lost.tried = t;
    auto found = look_for(candidate.track, lost, guidance, candidate.expected, recent);
    if (!found) continue;
    const auto is_near = [&](const Found& other) { return (other.pixel - found->pixel).norm() < distance; };
    if (std::ranges::none_of(result, is_near)) result.push_back(std::move(*found));
  }
  return result;
}

/// The position around `about` where the events match the template best, if no second one in reach matches as well.
std::optional<LostLandmarks::Found> LostLandmarks::look_for(TrackId track, const Lost& lost, const Guidance& guidance,
                                                            const Vector2& about, const RecentEvents& recent) const {
  constexpr double kBeside = 3.0;      // [px] a second match is farther than this from the best one
  constexpr double kAmbiguous = 0.95;  // and as good if its score is more than this share of the best one
  constexpr double kNearest = 2.0;     // [px] least search radius
  const double t = middle_of(window_at(about, recent));
  const auto expected = guidance.predict(track, t);
  if (!expected) return std::nullopt;
  const double sigma = std::sqrt(expected->covariance.diagonal().maxCoeff());
  const int radius = std::min(options_.search, static_cast<int>(std::ceil(kNearest + options_.gate * sigma)));
  Found found = as_expected(track, lost, guidance, t);
  const Pixel place{static_cast<int>(std::lround(expected->pixel.x())),
                    static_cast<int>(std::lround(expected->pixel.y()))};
  const std::vector<Alignment> places = align_around(found.look, recent.events(), place, radius);
  const auto best = std::ranges::max_element(places, {}, &Alignment::score);
  if (best == places.end() || best->event_count < kWindowSize || best->score < options_.similarity) return std::nullopt;
  // A match at the edge of the searched area is no maximum.
  if (std::abs(best->x - place.x) == radius || std::abs(best->y - place.y) == radius) return std::nullopt;
  for (const Alignment& other : places) {
    const bool beside = std::hypot(other.x - best->x, other.y - best->y) > kBeside;
    if (beside && other.score > kAmbiguous * best->score) return std::nullopt;
  }
  found.pixel = Vector2(best->x, best->y);
  return found;
}

std::vector<LostLandmarks::Found> LostLandmarks::find_displaced(const Guidance& guidance, double t,
                                                                const RecentEvents& recent, const Tracked& tracked,
                                                                const Camera& camera) {
  constexpr double kPause = 0.05, kQuietPause = 0.2;  // [s] to the next search; where most are as expected
  constexpr std::ptrdiff_t kEnough = 5;               // and at least so many of them
  constexpr std::size_t kMost = 40;                   // searched for at a time
  constexpr double kApart = 5.0;                      // [px]: two landmarks nearer than this are at one corner
  if (t < next_displaced_ || !guidance.available() || recent.events().empty() || options_.displacement == 0) return {};
  forget_before(t - options_.memory);
  next_displaced_ = t + kPause;
  std::vector<Candidate> candidates = expected_in_view(guidance, t, tracked, camera);
  std::erase_if(candidates, [&](const Candidate& candidate) { return candidate.tried > t; });
  std::vector<Displaced> seen;
  std::vector<Found> looks;
  const std::size_t count = std::min(candidates.size(), kMost);
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [track, about, tried] = candidates[i * candidates.size() / count];  // both recently and long lost ones
    const double middle = middle_of(window_at(about, recent));
    const auto expected = guidance.predict(track, middle);
    if (!expected) continue;
    Found found = as_expected(track, lost_.at(track), guidance, middle);
    const auto place =
        most_like(found.look, recent.events(), expected->pixel, options_.displacement, options_.similarity);
    const auto pixel = place ? camera.undistort(*place) : std::nullopt;
    const auto is_near = [&](const Displaced& other) { return (other.pixel - *pixel).norm() < kApart; };
    if (!pixel || std::ranges::any_of(seen, is_near)) continue;
    found.pixel = *place;
    looks.push_back(std::move(found));
    const Vector3 point = guidance.pose(middle).inverse() * *guidance.position(track);
    seen.push_back({track, *pixel, *pixel - camera.pinhole.project(point), point});
  }
  const auto in_place =
      std::ranges::count_if(seen, [&](const Displaced& one) { return one.displacement.norm() <= options_.search; });
  if (in_place >= kEnough && 2 * in_place >= std::ssize(seen)) next_displaced_ = t + kQuietPause;
  const std::vector<Displaced> displaced = displaced_together(seen, camera.pinhole, options_.search);
  std::vector<Found> result;
  std::ranges::copy_if(looks, std::back_inserter(result), [&](const Found& found) {
    return std::ranges::find(displaced, found.track, &Displaced::track) != displaced.end();
  });
  return result;
}

std::optional<LostLandmarks::Found> LostLandmarks::recognise(const Vector2& about, std::size_t world,
                                                             const RecentEvents& recent, double t,
                                                             const Tracked& tracked) {
  forget_before(t - options_.memory);
  std::vector<KnownLook> looks;
  for (const auto& [track, lost] : lost_) {
    if (lost.world != world && !tracked.has(track)) looks.push_back({track, &lost.look, lost.angle});
  }
  const auto found = haste::recognise(looks, window_at(about, recent), about, options_.recognition);
  if (!found) return std::nullopt;
  return Found{found->track, found->pixel, lost_.at(found->track).look.warped(found->angle, 1.0)};
}

}  // namespace evbench::haste
