#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/events/event_time.hpp"
#include "core/support/index.hpp"
#include "core/support/median.hpp"
#include "frontends/haste/haste.hpp"
#include "frontends/haste/tracking/alignment.hpp"

// A tracker ends where its pattern cannot be distinguished from the surroundings, or is no longer the same.
namespace evbench::haste {

/// Marks all trackers for a check after a silence of the whole sensor. A stationary camera still sees the same patterns
/// after it. A camera that moved meanwhile sees others, which trackers would take for the old landmarks.
void Haste::doubt_trackers() {
  for (auto& [id, track] : tracks_) {
    const Tracker& tracker = trackers_.tracker(id);
    if (!tracker.running()) continue;
    track.doubted = tracker.event_count();
    remember(track, tracker);
  }
}

/// Ends mismatched tracks after a silence, as soon as their windows hold only new events.
void Haste::end_mismatched() {
  for (const std::int64_t id : trackers_.ids()) {
    const Tracker& tracker = trackers_.tracker(id);
    Track& track = tracks_.at(id);
    if (track.doubted < 0 || tracker.event_count() - track.doubted < kWindowSize) continue;
    track.doubted = -1;
    std::vector<Event> window;
    for (int i = 0; i < kWindowSize; ++i) window.push_back(tracker.window().event(i));
    const Alignment seen = align(tracker.learnt_template(), window, tracker.grid_state());
    if (seen.score < options_.life.recognition) {
      end(id, End::silence);
    } else {
      lost_.forget(track.id);
    }
  }
}

/// Ends erratic trackers. Within a tick no camera moves far to and fro, and the image moves about equally everywhere.
/// So a tracker stays within the box between its old and its new position, but for small steps to and fro, and moves
/// with the others. A burst of noise takes each tracker elsewhere. The observations of an erratic tracker since the
/// last tick are dropped, and its path does not count as motion of the image.
void Haste::end_erratic() {
  constexpr double kAside = 4.0;        // [px] by which the box of its positions may exceed its displacement
  constexpr double kFromOthers = 0.05;  // of the image's width; a turn at 660 degrees/s makes 0.03 at its border
  constexpr std::size_t kEnough = 5;
  std::vector<double> x, y;
  for (const auto& [tracker, track] : tracks_) {
    x.push_back(track.pixel.x() - track.from.x());
    y.push_back(track.pixel.y() - track.from.y());
  }
  if (x.empty()) return;
  const bool enough = x.size() >= kEnough;
  const Vector2 usual(median(std::move(x)), median(std::move(y)));
  double way = 0.0;
  std::vector<std::int64_t> erratic;
  for (const auto& [tracker, track] : tracks_) {
    const Vector2 moved = track.pixel - track.from;
    const bool aside = track.visited.diagonal().norm() - moved.norm() > kAside;
    if (!aside && !(enough && (moved - usual).norm() > kFromOthers * camera_.width)) continue;
    way += track.way;
    erratic.push_back(tracker);
  }
  if (erratic.empty()) return;
  odometer_ -= way / static_cast<double>(tracks_.size());
  for (auto& [tracker, track] : tracks_) track.odometer = std::min(track.odometer, odometer_);
  for (const std::int64_t tracker : erratic) end(tracker, End::erratic);
}

void Haste::end_trackers() {
  const LifeOptions& life = options_.life;
  const auto crowded = [&](std::int64_t tracker, const Vector2& pixel) {
    return std::ranges::any_of(tracks_, [&](const auto& other) {
      return other.first < tracker && (other.second.pixel - pixel).norm() < life.crowding;
    });
  };
  for (const std::int64_t id : trackers_.ids()) {
    const Tracker& tracker = trackers_.tracker(id);
    Track& track = tracks_.at(id);
    if (!camera_.contains(track.pixel, life.border)) {
      end(id, End::border);
    } else if (tracker.running() && tracker.scores().spread() < life.spread) {
      end(id, End::spread);
    } else if (tracker.running() && tracker.scores().weakest_curvature() < life.curvature) {
      end(id, End::edge);
    } else if (life.starvation > 0.0 && odometer_ - track.odometer > life.starvation) {
      end(id, End::starvation);
    } else if (crowded(id, track.pixel)) {
      end(id, End::crowding);
    } else {
      if (track.doubted < 0) track.found = track.reported;
      track.from = track.pixel;
      track.way = 0.0;
      track.visited = Eigen::AlignedBox2d(track.pixel);
    }
  }
}

/// Ends trackers far from where their landmarks are expected. Where many are, the expectation is wrong instead, which
/// is likely where it comes from a motion model alone.
void Haste::veto_strays() {
  if (!guidance_.reliable()) return;
  const GuidanceOptions& guidance = options_.guidance;
  std::vector<std::int64_t> strays;
  std::size_t expected = 0;
  for (const auto& [tracker, track] : tracks_) {
    const TrackerState& state = trackers_.tracker(tracker).state();
    if (track.probation > 0 || track.displaced) continue;
    const auto prediction = guidance_.predict(track.id, seconds(state.t));
    if (!prediction) continue;
    ++expected;
    const Vector2 error = state.position - prediction->pixel;
    const Matrix2 covariance = prediction->covariance + options_.sigma * options_.sigma * Matrix2::Identity();
    const double distance = std::sqrt(error.dot(covariance.inverse() * error));
    if (error.norm() > guidance.veto_distance && distance > guidance.gate) strays.push_back(tracker);
  }
  if (3 * strays.size() > expected) return;
  for (const std::int64_t tracker : strays) end(tracker, End::veto);
}

/// Ends a tracker. Where its track is one of the back-end's landmarks, its template is stored, unless it follows
/// something else by now.
void Haste::end(std::int64_t tracker, End why) {
  const auto found = tracks_.find(tracker);
  const Track& track = found->second;
  ++ended_[index(static_cast<int>(why))];
  if (track.probation > 0) {
    lost_.disappoint(track.id, clock_);
  } else {
    // Observations newer than the delay are not published yet, whatever the exchange interval.
    const bool doubted = track.doubted >= 0;  // it ends before it could be checked
    if (why == End::erratic || why == End::silence || doubted) {
      delayed_.take_back(track.id, std::max(track.found, clock_ - options_.delay));
    }
    delayed_.end({track.id, clock_});
    if (track.displaced && why == End::outlier) lost_.disappoint(track.id, clock_);
    const bool itself = !doubted && (why == End::border || why == End::starvation);
    if (itself) remember(track, trackers_.tracker(tracker));
  }
  trackers_.remove(tracker);
  tracks_.erase(found);
}

}  // namespace evbench::haste
