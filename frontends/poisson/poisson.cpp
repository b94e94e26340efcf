#include "frontends/poisson/poisson.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/events/event_time.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/index.hpp"
#include "core/support/median.hpp"
#include "core/support/parallel.hpp"
#include "frontends/poisson/contrast.hpp"

namespace evbench::poisson {
namespace {

const Registration<FrontEnd, Poisson> registration(
    "poisson", "tracks features asynchronously by the likelihood of events, a Poisson process", 2);

constexpr double kLeastStep = 1e-6;  ///< [s] between two observations of a track

}  // namespace

Poisson::Poisson(const Options& options, const FrontEndContext& context)
    : EventFrontEnd(context, "poisson"),
      options_(options),
      seeds_(options.seeds, context.folder),
      recent_(static_cast<std::size_t>(std::max(options.recent, options.detection.events))),
      latest_(range_.from),
      detected_(range_.from),
      next_id_(seeds_.next_id()) {
  check_border(options.detection.border, camera_, context.place + ".detection.border");
  check_border(options.life.border, camera_, context.place + ".life.border");
}

void Poisson::take(std::span<const Event> events) {
  while (seeds_.next() <= seconds(events.back().t)) {
    const double t = seeds_.next();
    const auto rest = std::ranges::upper_bound(events, t, {}, [](const Event& event) { return seconds(event.t); });
    process({events.begin(), rest});
    for (const TrackObservation& seed : seeds_.take(t)) {
      if (begin(seed.track, seed.pixel, t))
        delayed_.add({seed.track, tracks_.back().reported, seed.pixel, options_.sigma});
    }
    events = {rest, events.end()};
    if (events.empty()) return;
  }
  process(events);
}

void Poisson::process(std::span<const Event> events) {
  recent_.add(events);
  latest_ = seconds(events.back().t);
  observations_.resize(tracks_.size());
  parallel_for(options_.threads, static_cast<int>(tracks_.size()), [&](int i) {
    observations_[index(i)].clear();
    tracks_[index(i)].tracker.push(events, observations_[index(i)]);
  });
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    for (const Tracker::Observation& z : observations_[i]) report(tracks_[i], z);
  }
}

void Poisson::report(Track& track, const Tracker::Observation& z) {
  if (track.settling > 0) {
    --track.settling;
    return;
  }
  const PixelNoise left = options_.covariance ? PixelNoise(z.covariance) : PixelNoise(z.deviation);
  const PixelNoise noise = left + options_.sigma;
  const double t = std::max({z.t, track.reported + kLeastStep, complete() + kLeastStep});
  // Such a track ends at the next tick. So does one of which too much has happened at one time.
  if (!noise.is_valid() || !camera_.contains(z.position, 0.0) || t > latest_) return;
  track.reported = t;
  delayed_.add({track.id, t, z.position, noise});
}

void Poisson::on_tick() {
  std::vector<double> x, y;
  std::vector<Tracker::Observation> observations;
  for (Track& track : tracks_) {
    observations.clear();
    track.tracker.pass(clock_, clock_ + 1.2 * kTick - options_.delay, observations);
    for (const Tracker::Observation& z : observations) report(track, z);
    const Vector2& velocity = track.tracker.velocity();
    if (!velocity.allFinite()) continue;
    x.push_back(velocity.x());
    y.push_back(velocity.y());
  }
  if (!x.empty()) odometer_ += kTick * std::hypot(median(std::move(x)), median(std::move(y)));
  if (options_.neighbours) expect_neighbours();
  end_trackers();
  if (!seeds_.given() && clock_ - detected_ >= options_.detection.interval) replenish();
}

/// The motion that each track's neighbours have, each as far as it knows its own: those before edges know it across
/// them, and together they know all of it. Neighbours at other depths move differently.
void Poisson::expect_neighbours() {
  constexpr double kDepth = 0.2;   // share of a neighbour's velocity that may be due to its depth
  constexpr double kSlow = 5.0;    // [px/s] by which it may differ, however slow it is
  constexpr double kAgain = 2.0;   // factor of the variance: from tick to tick neighbours say much the same
  constexpr double kReach = 0.15;  // standard deviation of the distance to neighbours, as a share of the width
  const auto differing = [](const Vector2& velocity) -> Matrix2 {
    const double other = kDepth * velocity.norm() + kSlow;
    return other * other * Matrix2::Identity();
  };
  struct Motion {
    Vector2 pixel, velocity;
    Matrix2 information;
  };
  std::vector<Motion> motions;
  for (const Track& track : tracks_) {
    const Vector2& velocity = track.tracker.velocity();
    const Matrix2 covariance = track.tracker.velocity_covariance() + differing(velocity);
    motions.push_back({track.tracker.position(clock_), velocity, covariance.inverse()});
  }
  const double reach = kReach * camera_.width;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    Matrix2 information = Matrix2::Zero();
    Vector2 sum = Vector2::Zero();
    for (std::size_t j = 0; j < motions.size(); ++j) {
      if (i == j) continue;
      const double near = std::exp(-0.5 * (motions[j].pixel - motions[i].pixel).squaredNorm() / (reach * reach));
      information += near * motions[j].information;
      sum += near * motions[j].information * motions[j].velocity;
    }
    const Matrix2 covariance = information.inverse();
    const Vector2 velocity = covariance * sum;
    tracks_[i].tracker.expect(velocity, kAgain * (covariance + differing(velocity)));
  }
}

void Poisson::end_trackers() {
  std::vector<Track> kept;
  for (Track& track : tracks_) {
    if (track.tracker.newest() > track.corrected) {
      track.corrected = track.tracker.newest();
      track.odometer = odometer_;
    }
    if (const auto why = reason_to_end(track, kept)) {
      end(track, *why);
    } else {
      kept.push_back(std::move(track));
    }
  }
  tracks_ = std::move(kept);
}

std::optional<Poisson::End> Poisson::reason_to_end(const Track& track, std::span<const Track> older) const {
  constexpr double kUnknown = 1.5;  // [px] deviation of the present position
  const LifeOptions& life = options_.life;
  const Tracker& tracker = track.tracker;
  const Vector2 pixel = tracker.position(clock_);
  if (!pixel.allFinite() || !camera_.contains(pixel, life.border)) return End::border;
  if (!(tracker.observed_deviation() <= life.deviation && tracker.deviation() < kUnknown)) return End::deviation;
  if (life.starvation > 0.0 && odometer_ - track.odometer > life.starvation) return End::starvation;
  const auto is_near = [&](const Track& other) {
    return (other.tracker.position(clock_) - pixel).norm() < life.crowding;
  };
  if (std::ranges::any_of(older, is_near)) return End::crowding;
  return std::nullopt;
}

void Poisson::end(const Track& track, End why) {
  ++ended_[index(static_cast<int>(why))];
  delayed_.end({track.id, clock_});
}

/// Detects new features where there are too few.
void Poisson::replenish() {
  const auto wanted = static_cast<std::size_t>(options_.tracks);
  const std::span<const Event> newest = recent_.newest(static_cast<std::size_t>(options_.detection.events));
  if (tracks_.size() >= wanted || 5 * newest.size() < static_cast<std::size_t>(options_.detection.events)) return;
  detected_ = clock_;
  std::vector<Vector2> taken;
  for (const Track& track : tracks_) taken.push_back(track.tracker.position(clock_));
  DetectionOptions detection = options_.detection;
  detection.border = std::max(detection.border, options_.life.border);
  for (const Vector2& pixel :
       detect_features(detection, newest, camera_.width, camera_.height, taken, wanted - tracks_.size())) {
    if (begin(next_id_, pixel, std::nullopt)) ++next_id_;
  }
}

/// `at`: when the point is there [s]; else at the middle of the events around it. Returns whether there are enough.
bool Poisson::begin(TrackId id, const Vector2& pixel, std::optional<double> at) {
  constexpr std::size_t kFewest = 20;
  const std::vector<Event> window = events_around(pixel);
  if (window.size() < kFewest || !camera_.contains(pixel, options_.life.border)) return false;
  ++begun_;
  const Vector2 velocity = sharpest_velocity(window, pixel, options_.tracker.radius);
  const double middle = 0.5 * (seconds(window.front().t) + seconds(window.back().t));
  tracks_.push_back({.id = id,
                     .tracker = Tracker(options_.tracker, pixel, at.value_or(middle), velocity, window),
                     .settling = options_.settling,
                     .reported = std::max(at.value_or(range_.from), complete() + kLeastStep),
                     .odometer = odometer_});
  return true;
}

/// The newest ones, in time order.
std::vector<Event> Poisson::events_around(const Vector2& pixel) const {
  std::vector<Event> around;
  const std::span<const Event> all = recent_.newest(static_cast<std::size_t>(options_.recent));
  const double square = options_.tracker.radius * options_.tracker.radius;
  for (auto event = all.rbegin(); event != all.rend() && std::ssize(around) < options_.window; ++event) {
    if ((Vector2(event->x, event->y) - pixel).squaredNorm() < square) around.push_back(*event);
  }
  std::ranges::reverse(around);
  return around;
}

FeedbackNeeds Poisson::needs() const { return {options_.outliers, false, false}; }

void Poisson::receive(const Feedback& feedback) {
  std::erase_if(tracks_, [&](const Track& track) {
    const bool is_outlier = std::ranges::find(feedback.outliers, track.id) != feedback.outliers.end();
    if (is_outlier) end(track, End::outlier);
    return is_outlier;
  });
}

std::vector<std::string> Poisson::counts() const {
  const auto ended = [&](End why) { return ended_[index(static_cast<int>(why))]; };
  return {fmt::format("{} tracks begun, {} tracked at the end", begun_, tracks_.size()),
          fmt::format("trackers that ended: {} at the border, {} as their positions were uncertain, {} starved, {} "
                      "crowded, {} as outliers",
                      ended(End::border), ended(End::deviation), ended(End::starvation), ended(End::crowding),
                      ended(End::outlier))};
}

}  // namespace evbench::poisson
