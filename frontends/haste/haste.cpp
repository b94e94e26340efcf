#include "frontends/haste/haste.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/events/event_time.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/index.hpp"
#include "core/support/median.hpp"
#include "frontends/haste/tracking/alignment.hpp"

namespace evbench::haste {
namespace {

const Registration<FrontEnd, Haste> registration(
    "haste",
    "tracks features in events asynchronously by hypotheses (Alzugaray and Chli 2020), finds lost landmarks again", 7);

constexpr double kApart = 1e-6;  ///< [s] between two observations of a track, at least

Vector2 place_of(const Change& change, Options::Place place) {
  switch (place) {
    case Options::Place::new_state: return change.after.position;
    case Options::Place::midpoint: return midpoint(change);
    case Options::Place::refined: return refined_position(change);
  }
  return change.after.position;
}

}  // namespace

Haste::Haste(const Options& options, const FrontEndContext& context)
    : EventFrontEnd(context, "haste"),
      options_(options),
      sigma_(options.sigma),
      recent_(static_cast<std::size_t>(options.detection.events)),
      trackers_(camera_.width, camera_.height, options.threads),
      guidance_(camera_, options.guidance.degraded),
      lost_(options.guidance),
      looked_(range_.from),
      detected_(range_.from),
      last_event_(range_.from) {
  check_border(options.detection.border, camera_, context.place + ".detection.border");
  check_border(options.life.border, camera_, context.place + ".life.border");
}

void Haste::take(std::span<const Event> events) {
  constexpr double kSilence = 0.1;  // [s], longer than from one tick to the next: an end of it is at the front
  if (seconds(events.front().t) - last_event_ > kSilence) doubt_trackers();
  last_event_ = seconds(events.back().t);
  recent_.add(events);
  changes_.clear();
  trackers_.push(events, changes_);
  for (const Change& change : changes_) observe(change);
}

void Haste::observe(const Change& change) {
  const auto found = tracks_.find(change.tracker);
  Track& track = found->second;
  const double way = (change.after.position - change.before.position).norm();
  odometer_ += way / static_cast<double>(tracks_.size());
  track.way += way;
  track.visited.extend(change.after.position);
  track.odometer = odometer_;
  track.pixel = change.after.position;
  const double sigma = options_.score_sigma ? sigma_.next(change.scores) : options_.sigma;
  TrackObservation z{track.id, seconds(change.after.t), place_of(change, options_.place), sigma};
  const double told = std::max(seconds(change.t_event), clock_) - options_.delay;  // what stands for times up to then
  if (z.t <= told) ++late_;
  z.t = std::max({z.t, told, track.told + kApart});
  if (track.probation > 0) {
    if (!is_as_expected(track.id, z.pixel, z.t)) {
      lost_.disappoint(track.id, clock_);
      track = {.id = next_id_++,
               .odometer = track.odometer,
               .pixel = track.pixel,
               .from = track.from,
               .way = track.way,
               .visited = track.visited};
      z.track = track.id;
    } else if (--track.probation > 0) {
      return;
    } else {
      lost_.forget(track.id);
      ++(track.at_corner ? at_corners_ : by_template_).went_on;
    }
  }
  if (track.displaced && is_as_expected(track.id, z.pixel, z.t)) {
    track.displaced = false;
    lost_.forget(track.id);
  }
  track.told = z.t;
  told_.add(z);
}

bool Haste::is_as_expected(TrackId track, const Vector2& pixel, double t) const {
  const auto expected = guidance_.predict(track, t);
  return expected && (pixel - expected->pixel).norm() < options_.guidance.tolerance;
}

void Haste::look() {
  end_wanderers();
  end_strangers();
  end_trackers();
  correct_guidance();
  if (options_.guidance.veto) veto_strays();
  if (last_event_ <= looked_) return;  // nothing is seen in which there was nothing before
  looked_ = clock_;
  if (options_.guidance.reacquire) {
    reacquire();
    reacquire_displaced();
    recognise();
  }
  if (clock_ - detected_ >= options_.detection.interval) replenish();
}

/// A camera that stood still goes on to see what it saw; one that told nothing meanwhile sees something else, of which
/// trackers would make the old landmarks.
void Haste::doubt_trackers() {
  for (auto& [id, track] : tracks_) {
    const Tracker& tracker = trackers_.tracker(id);
    if (!tracker.running()) continue;
    track.doubted = tracker.event_count();
    remember(track, tracker);
  }
}

/// As the landmark that it is looks now, where it is one.
void Haste::remember(const Track& track, const Tracker& tracker) {
  const bool itself = track.probation == 0 && !track.displaced && guidance_.position(track.id);
  if (!options_.guidance.reacquire || !itself) return;
  lost_.remember(track.id, clock_, tracker.learnt_template(), tracker.state().angle, guidance_);
}

/// As soon as their windows are of new events.
void Haste::end_strangers() {
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

/// Within a tick, no camera goes far to and fro, and what it sees goes about the same way everywhere: a tracker has
/// been in the box between where it was and where it is, but for the small steps to and fro that each makes, and goes
/// with the others. A burst of noise takes each of them somewhere else. What one told since the last tick is then no
/// observation, and its way none of the image's.
void Haste::end_wanderers() {
  constexpr double kAside = 4.0;        // [px] by which the box that it has been in is longer than what it moved
  constexpr double kFromOthers = 0.05;  // of the image's width; 0.03 at its border in a turn by 660 degrees a second
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
  std::vector<std::int64_t> wanderers;
  for (const auto& [tracker, track] : tracks_) {
    const Vector2 moved = track.pixel - track.from;
    const bool aside = track.visited.diagonal().norm() - moved.norm() > kAside;
    if (!aside && !(enough && (moved - usual).norm() > kFromOthers * camera_.width)) continue;
    way += track.way;
    wanderers.push_back(tracker);
  }
  if (wanderers.empty()) return;
  odometer_ -= way / static_cast<double>(tracks_.size());
  for (auto& [tracker, track] : tracks_) track.odometer = std::min(track.odometer, odometer_);
  for (const std::int64_t tracker : wanderers) end(tracker, End::wandering);
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
      if (track.doubted < 0) track.found = track.told;
      track.from = track.pixel;
      track.way = 0.0;
      track.visited = Eigen::AlignedBox2d(track.pixel);
    }
  }
}

void Haste::correct_guidance() {
  std::vector<Guidance::Sighting> sightings;
  for (const auto& [tracker, track] : tracks_) {
    const TrackerState& state = trackers_.tracker(tracker).state();
    if (track.probation == 0 && !track.displaced) sightings.push_back({track.id, seconds(state.t), state.position});
  }
  guidance_.correct(sightings);
}

/// Trackers far from where their landmarks are expected; but when many are, it is the expectation that is wrong, and it
/// may well be where a motion model alone makes it.
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

/// Landmarks that come back into view, as long as there is room for them.
void Haste::reacquire() {
  if (trackers_.size() >= static_cast<std::size_t>(2 * options_.tracks)) return;
  const auto found = lost_.find(guidance_, clock_, recent_, tracked(), options_.life.crowding + 1.0, camera_);
  for (const LostLandmarks::Found& landmark : found) {
    ++by_template_.found;
    begin(Tracker(options_.tracker, {0, landmark.pixel, 0.0}, landmark.look),
          {landmark.track, odometer_, landmark.pixel, options_.guidance.probation});
  }
}

/// Where the camera has turned unnoticed; trackers that are there are on these landmarks. Whether they are what they
/// seem is for the back-end to say.
void Haste::reacquire_displaced() {
  if (trackers_.size() >= static_cast<std::size_t>(2 * options_.tracks)) return;
  for (const LostLandmarks::Found& landmark : lost_.find_displaced(guidance_, clock_, recent_, tracked(), camera_)) {
    std::vector<std::int64_t> there;
    for (const auto& [tracker, track] : tracks_) {
      if ((track.pixel - landmark.pixel).norm() < options_.life.crowding) there.push_back(tracker);
    }
    for (const std::int64_t tracker : there) end(tracker, End::crowding);
    ++begun_displaced_;
    begin(Tracker(options_.tracker, {0, landmark.pixel, 0.0}, landmark.look),
          {.id = landmark.track, .odometer = odometer_, .pixel = landmark.pixel, .displaced = true});
  }
}

/// After a loss new trackers may be on landmarks of the map that there was, wherever these are now: a few of them are
/// compared at a time.
void Haste::recognise() {
  constexpr std::size_t kAtATime = 4;
  constexpr int kTimes = 3;
  if (!lost_.has_of_another(guidance_.world())) return;
  std::vector<std::int64_t> candidates;
  for (const auto& [tracker, track] : tracks_) {
    const bool is_new = track.looked_at < kTimes && track.probation == 0 && !guidance_.position(track.id);
    if (is_new && trackers_.tracker(tracker).running()) candidates.push_back(tracker);
  }
  std::ranges::stable_sort(candidates, {}, [&](std::int64_t tracker) { return tracks_.at(tracker).looked_at; });
  if (candidates.size() > kAtATime) candidates.resize(kAtATime);
  for (const std::int64_t tracker : candidates) {
    Track& track = tracks_.at(tracker);
    ++track.looked_at;
    auto found = lost_.recognise(track.pixel, guidance_.world(), recent_, clock_, tracked());
    if (!found) continue;
    end(tracker, End::recognised);
    lost_.forget(found->track);
    begin(Tracker(options_.tracker, {0, found->pixel, 0.0}, found->look),
          {.id = found->track, .odometer = odometer_, .pixel = found->pixel, .looked_at = kTimes});
  }
}

/// New features where there are too few, some of which are lost landmarks.
void Haste::replenish() {
  const auto wanted = static_cast<std::size_t>(options_.tracks);
  if (trackers_.size() >= wanted || 5 * recent_.events().size() < static_cast<std::size_t>(options_.detection.events)) {
    return;
  }
  detected_ = clock_;
  const auto features = detect_features(options_.detection, recent_.events(), camera_.width, camera_.height,
                                        tracked().places, wanted - trackers_.size());
  for (const Vector2& pixel : features) {
    Tracker tracker(options_.tracker, {0, pixel, 0.0});
    if (const std::optional<TrackId> landmark = lost_landmark_at(pixel)) {
      ++at_corners_.found;
      begin(std::move(tracker), {*landmark, odometer_, pixel, options_.guidance.probation, true});
    } else {
      ++begun_;
      begin(std::move(tracker), {next_id_++, odometer_, pixel});
    }
  }
}

/// Those with a template have been looked for by it before.
std::optional<TrackId> Haste::lost_landmark_at(const Vector2& corner) const {
  const std::span<const Event> window = recent_.window(corner);
  if (!options_.guidance.reacquire || !options_.guidance.corners || window.empty()) return std::nullopt;
  return lost_.at_corner(corner, guidance_, seconds(window[window.size() / 2].t), tracked());
}

/// With the events that have been around there of late, so that it need not wait for its window to be full.
void Haste::begin(Tracker tracker, const Track& track) {
  for (const Event& event : recent_.window(track.pixel)) tracker.push(event);
  const bool runs = tracker.running();
  Change start = tracker.change();
  start.tracker = trackers_.add(std::move(tracker));
  tracks_.emplace(start.tracker, track);
  if (runs) observe(start);
}

/// One whose track is the back-end's landmark is remembered as it looks now, unless it is not that any more.
void Haste::end(std::int64_t tracker, End why) {
  const auto found = tracks_.find(tracker);
  const Track& track = found->second;
  ++ended_[index(static_cast<int>(why))];
  if (track.probation > 0) {
    lost_.disappoint(track.id, clock_);
  } else {
    // Nothing of this has been told that is younger than the delay, however the run exchanges.
    const bool doubted = track.doubted >= 0;  // it ends before it could be looked at
    if (why == End::wandering || why == End::silence || doubted) {
      told_.take_back(track.id, std::max(track.found, clock_ - options_.delay));
    }
    told_.end({track.id, clock_});
    if (track.displaced && why == End::outlier) lost_.disappoint(track.id, clock_);
    const bool itself = !doubted && (why == End::border || why == End::starvation);
    if (itself) remember(track, trackers_.tracker(tracker));
  }
  trackers_.remove(tracker);
  tracks_.erase(found);
}

LostLandmarks::Tracked Haste::tracked() const {
  LostLandmarks::Tracked result;
  for (const auto& [tracker, track] : tracks_) {
    result.tracks.push_back(track.id);
    result.places.push_back(track.pixel);
  }
  return result;
}

FeedbackNeeds Haste::needs() const {
  const GuidanceOptions& guidance = options_.guidance;
  const bool expects = guidance.veto || guidance.reacquire;
  return {guidance.outliers || expects, false, expects};
}

void Haste::receive(const Feedback& feedback) {
  guidance_.receive(feedback);
  if (feedback.state == TrackingState::no_map) lost_.forget_world(feedback.world);  // where there was a map, it is gone
  if (!options_.guidance.outliers || feedback.outliers.empty()) return;
  for (const std::int64_t tracker : trackers_.ids()) {
    const Track& track = tracks_.at(tracker);
    if (std::ranges::find(feedback.outliers, track.id) != feedback.outliers.end()) end(tracker, End::outlier);
  }
}

std::vector<std::string> Haste::counts() const {
  const auto ended = [&](End why) { return ended_[index(static_cast<int>(why))]; };
  return {
      fmt::format("{} features detected, {} tracked at the end", begun_, tracks_.size()),
      fmt::format("trackers that ended: {} at the border, {} as their hypotheses were alike, {} before an edge, "
                  "{} starved, {} crowded, {} far from where they were expected, {} as outliers, {} wandering in "
                  "noise, {} before something else after a silence",
                  ended(End::border), ended(End::spread), ended(End::edge), ended(End::starvation),
                  ended(End::crowding), ended(End::veto), ended(End::outlier), ended(End::wandering),
                  ended(End::silence)),
      fmt::format(
          "{} landmarks found again, of which {} went on; {} at corners, of which {} went on; {} displaced together; "
          "{} recognised after a loss",
          by_template_.found, by_template_.went_on, at_corners_.found, at_corners_.went_on, begun_displaced_,
          ended(End::recognised)),
      fmt::format("{} observations came later than the delay", late_)};
}

}  // namespace evbench::haste
