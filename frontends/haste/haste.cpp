#include "frontends/haste/haste.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/events/event_time.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/index.hpp"

namespace evbench::haste {
namespace {

const Registration<FrontEnd, Haste> registration(
    "haste",
    "tracks features in events asynchronously by hypotheses (Alzugaray and Chli 2020), re-acquires lost landmarks", 8);

constexpr double kLeastStep = 1e-6;  ///< [s] between two observations of a track, at least

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
      seeds_(options.seeds, context.folder),
      noise_(options.sigma),
      recent_(static_cast<std::size_t>(options.detection.events)),
      trackers_(camera_.width, camera_.height, options.threads),
      guidance_(camera_, options.guidance.degraded),
      lost_(options.guidance),
      looked_(range_.from),
      detected_(range_.from),
      last_event_(range_.from) {
  next_id_ = seeds_.next_id();
  check_border(options.detection.border, camera_, context.place + ".detection.border");
  check_border(options.life.border, camera_, context.place + ".life.border");
}

void Haste::take(std::span<const Event> events) {
  constexpr double kSilence = 0.1;  // [s], longer than a tick, so that a silence can end only at the first event
  if (seconds(events.front().t) - last_event_ > kSilence) doubt_trackers();
  last_event_ = seconds(events.back().t);
  while (seeds_.next() <= last_event_) {
    const double t = seeds_.next();
    const auto rest = std::ranges::upper_bound(events, t, {}, [](const Event& event) { return seconds(event.t); });
    process({events.begin(), rest});
    start_seeds(t);
    events = {rest, events.end()};
  }
  process(events);
}

void Haste::process(std::span<const Event> events) {
  if (events.empty()) return;
  recent_.add(events);
  changes_.clear();
  trackers_.push(events, changes_);
  for (const Change& change : changes_) observe(change);
}

/// Tracks begin with their seeds.
void Haste::start_seeds(double t) {
  for (const TrackObservation& seed : seeds_.take(t)) {
    if (!camera_.contains(seed.pixel, options_.life.border)) continue;
    ++begun_;
    const double at = std::max(t, clock_ - options_.delay);
    delayed_.add({seed.track, at, seed.pixel, options_.sigma});
    begin(Tracker(options_.tracker, {0, seed.pixel, 0.0}),
          {.id = seed.track, .odometer = odometer_, .pixel = seed.pixel, .reported = at, .from = seed.pixel});
  }
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
  const PixelNoise noise = options_.score_covariance ? noise_.next(change.scores) : options_.sigma;
  TrackObservation z{track.id, seconds(change.after.t), place_of(change, options_.place), noise};
  const double published = std::max(seconds(change.t_event), clock_) - options_.delay;  // published up to here
  if (z.t <= published) ++late_;
  z.t = std::max({z.t, published, track.reported + kLeastStep});
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
      ++by_template_.went_on;
    }
  }
  if (track.displaced && is_as_expected(track.id, z.pixel, z.t)) {
    track.displaced = false;
    lost_.forget(track.id);
  }
  track.reported = z.t;
  delayed_.add(z);
}

bool Haste::is_as_expected(TrackId track, const Vector2& pixel, double t) const {
  const auto expected = guidance_.predict(track, t);
  return expected && (pixel - expected->pixel).norm() < options_.guidance.tolerance;
}

void Haste::on_tick() {
  if (options_.life.erratic) end_erratic();
  end_mismatched();
  end_trackers();
  correct_guidance();
  if (options_.guidance.veto) veto_strays();
  if (last_event_ <= looked_) return;  // no new events to search in
  looked_ = clock_;
  if (options_.guidance.reacquire) {
    reacquire();
    reacquire_displaced();
    recognise();
  }
  if (!seeds_.given() && clock_ - detected_ >= options_.detection.interval) replenish();
}

void Haste::correct_guidance() {
  std::vector<Guidance::Sighting> sightings;
  for (const auto& [tracker, track] : tracks_) {
    const TrackerState& state = trackers_.tracker(tracker).state();
    if (track.probation == 0 && !track.displaced) sightings.push_back({track.id, seconds(state.t), state.position});
  }
  guidance_.correct(sightings);
}

/// Detects new features where there are too few.
void Haste::replenish() {
  const auto wanted = static_cast<std::size_t>(options_.tracks);
  if (trackers_.size() >= wanted || 5 * recent_.events().size() < static_cast<std::size_t>(options_.detection.events)) {
    return;
  }
  detected_ = clock_;
  const auto features = detect_features(options_.detection, recent_.events(), camera_.width, camera_.height,
                                        tracked().places, wanted - trackers_.size());
  for (const Vector2& pixel : features) {
    ++begun_;
    begin(Tracker(options_.tracker, {0, pixel, 0.0}), {next_id_++, odometer_, pixel});
  }
}

/// Fills the tracker's window with the recent events around it, so that it starts at once.
void Haste::begin(Tracker tracker, const Track& track) {
  for (const Event& event : window_at(track.pixel, recent_)) tracker.push(event);
  const bool runs = tracker.running();
  Change start = tracker.change();
  start.tracker = trackers_.add(std::move(tracker));
  tracks_.emplace(start.tracker, track);
  if (runs) observe(start);
}

FeedbackNeeds Haste::needs() const {
  const GuidanceOptions& guidance = options_.guidance;
  const bool expects = guidance.veto || guidance.reacquire;
  return {guidance.outliers || expects, false, expects};
}

void Haste::receive(const Feedback& feedback) {
  guidance_.receive(feedback);
  if (feedback.state == TrackingState::no_map) lost_.forget_world(feedback.world);  // a map that there was is gone
  if (!options_.guidance.outliers || feedback.outliers.empty()) return;
  for (const std::int64_t tracker : trackers_.ids()) {
    const Track& track = tracks_.at(tracker);
    if (std::ranges::find(feedback.outliers, track.id) != feedback.outliers.end()) end(tracker, End::outlier);
  }
}

std::vector<std::string> Haste::counts() const {
  const auto ended = [&](End why) { return ended_[index(static_cast<int>(why))]; };
  return {fmt::format("{} features detected, {} tracked at the end", begun_, tracks_.size()),
          fmt::format("trackers that ended: {} at the border, {} as their hypotheses were alike, {} along an edge, "
                      "{} starved, {} crowded, {} far from where they were expected, {} as outliers, {} erratic, "
                      "{} mismatched after a silence",
                      ended(End::border), ended(End::spread), ended(End::edge), ended(End::starvation),
                      ended(End::crowding), ended(End::veto), ended(End::outlier), ended(End::erratic),
                      ended(End::silence)),
          fmt::format("{} landmarks re-acquired by template, of which {} were confirmed; {} displaced together; "
                      "{} recognised after tracking was lost",
                      by_template_.found, by_template_.went_on, begun_displaced_, ended(End::recognised)),
          fmt::format("{} observations came later than the delay", late_)};
}

}  // namespace evbench::haste
