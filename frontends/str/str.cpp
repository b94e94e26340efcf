#include "frontends/str/str.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/events/event_time.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/index.hpp"
#include "frontends/str/expected_motion.hpp"

namespace evbench::str {
namespace {

const evbench::Registration<FrontEnd, Str> str_registration(
    "str", "registers batches of events as point clouds (after Liu, Parra and Chin 2021); tracks are chains of events",
    3);

/// The ray at another time, `dt` [s] later, under the motion A.
Eigen::Vector2f moved(const Eigen::Vector2f& ray, const Matrix3& A, double dt) {
  EventCloud one;
  one.add(ray.x(), ray.y(), static_cast<float>(-dt), false);
  std::vector<float> x, y;
  warp(one, A, x, y);
  return {x[0], y[0]};
}

/// Moves all points of a cloud by `dt` [s] under the motion A; their times stay.
void move(EventCloud& cloud, const Matrix3& A, double dt) {
  EventCloud at_once = cloud;
  std::ranges::fill(at_once.t, static_cast<float>(-dt));
  warp(at_once, A, cloud.x, cloud.y);
}

}  // namespace

Str::Str(const Options& options, const FrontEndContext& context)
    : EventFrontEnd(context, "str"),
      options_(options),
      seeds_(options.seeds, context.folder),
      batches_(options.batch, options.registration.slice, microseconds(range_.from)),
      registrar_(camera_, options.registration),
      complete_(range_.from) {
  check_border(options.detection.border, camera_, context.place + ".detection.border");
  check_border(options.patch.border, camera_, context.place + ".patch.border");
}

void Str::on_tick() {
  while (const auto batch = batches_.next(microseconds(clock_))) process(*batch);
}

void Str::process(const Batch& batch) {
  const Registration found = registrar_.align(batch, expected_);
  ++registered_[index(static_cast<int>(found.state))];
  grown_ += found.grown ? 1 : 0;
  expected_.reset();
  batches_.expect(0.0);
  batches_.learn(found.good() || found.state == Registration::State::too_few_events);
  if (found.state == Registration::State::too_few_events) {
    for (Track& track : tracks_) track.t = batch.to;  // the camera is nearly stationary: the tracks stay
  } else {
    go_on(batch, found);  // also with an unreliable motion: each track's own events decide
  }
  if (found.good()) {
    expected_ = found.A;
    batches_.expect(1e6 * found.motion / static_cast<double>(batch.to - batch.from));
    seeds_.given() ? start_seeds(batch, found) : replenish(batch, found);
  }
  complete_ = seconds(batch.to - 1);
}

void Str::go_on(const Batch& batch, const Registration& registration) {
  const std::int64_t slice =
      static_cast<std::int64_t>(options_.registration.slice * static_cast<double>(batch.to - batch.from));
  const auto last = std::ranges::lower_bound(batch.events, batch.from + slice, {}, &Event::t);
  make_cloud({batch.events.begin(), last}, registrar_.rays(), registration.reference, early_);
  warp(early_, registration.A, early_x_, early_y_);
  std::vector<Track> alive;
  for (Track& track : tracks_) {
    const bool crowded = std::ranges::any_of(
        alive, [&](const Track& older) { return (older.pixel - track.pixel).norm() < options_.patch.crowding; });
    crowded_ += crowded ? 1 : 0;
    if (!crowded && go_on(track, batch, registration)) {
      alive.push_back(track);
    } else {
      delayed_.end({track.id, seconds(batch.to - 1)});
    }
  }
  tracks_ = std::move(alive);
}

/// Aligns the events around a track once more, by translation, and observes it at the time of the event of the last
/// slice that corresponds to the one of the first slice that is nearest to it. False where it has to end.
bool Str::go_on(Track& track, const Batch& batch, const Registration& registration) {
  const double f = registrar_.rays().focal_length();
  const auto reach = static_cast<float>(options_.patch.radius / f);
  const auto since = [&](std::int64_t t) { return 1e-6 * static_cast<double>(t - registration.reference); };
  const Eigen::Vector2f here = moved(track.ray, registration.A, -since(track.t));
  std::vector<std::uint32_t> near;
  for (std::uint32_t i = 0; i < early_.size(); ++i) {
    const float dx = early_x_[i] - here.x(), dy = early_y_[i] - here.y();
    if (dx * dx + dy * dy < reach * reach) near.push_back(i);
  }
  patch_.clear();
  const std::size_t count = std::min(near.size(), static_cast<std::size_t>(options_.patch.queries));
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = near[k * near.size() / count];
    patch_.add(early_.x[i], early_.y[i], early_.t[i], early_.on[i] != 0);
  }
  Aligner& aligner = registrar_.aligner();
  const double duration = 1e-6 * static_cast<double>(batch.to - batch.from);
  const double gate = options_.registration.alignment.last_gate;
  const Alignment found = aligner.align(patch_, MotionModel::translation, registration.A, duration, gate);
  if (!found.converged || registration.beyond_chance(found.fit) < options_.patch.least_fit) {
    ++misfits_;
    return false;
  }
  move(track.anchor, found.A, -since(track.t));
  const Eigen::Vector2f place = anchored(track, found.A, moved(track.ray, found.A, -since(track.t)), duration);
  const std::vector<Match>& matches = aligner.match(patch_, found.A, gate);
  const auto nearest =
      std::ranges::min_element(matches, {}, [&](const Match& m) { return (m.at - place).squaredNorm(); });
  if (nearest == matches.end()) return false;
  const double dt = static_cast<double>(aligner.targets().t[nearest->target]);
  move(track.anchor, found.A, dt);
  const std::int64_t t = registration.reference + std::llround(1e6 * dt);
  observe_between(track, batch, place, found.A, registration.reference, t);
  observe(track, moved(place, found.A, dt), t);
  if (!camera_.contains(track.pixel, options_.patch.border)) {
    ++left_;
    return false;
  }
  return true;
}

/// The track's position at the reference time, corrected by aligning its anchor with the last slice: a chain alone
/// would accumulate the errors of its links. Where the anchor no longer fits, a new one is made of the aligned events.
Eigen::Vector2f Str::anchored(Track& track, const Matrix3& A, const Eigen::Vector2f& place, double duration) {
  Aligner& aligner = registrar_.aligner();
  const double gate = options_.registration.alignment.last_gate;
  // Moving the anchor but not the targets is also a velocity, if the whole anchor is seen half a batch earlier.
  const auto early = static_cast<float>(-0.5 * duration);
  EventCloud earlier = track.anchor;
  move(earlier, A, static_cast<double>(early));
  std::ranges::fill(earlier.t, early);
  Alignment found;
  if (earlier.size() > 0) found = aligner.align(earlier, MotionModel::translation, A, duration, gate);
  if (found.converged && found.fit >= options_.patch.anchor_fit) {
    double late = 0.0;  // mean time of the targets
    const std::vector<Match>& matches = aligner.match(earlier, found.A, gate);
    for (const Match& m : matches) late += static_cast<double>(aligner.targets().t[m.target]);
    late /= static_cast<double>(std::max<std::size_t>(matches.size(), 1));
    const double between = static_cast<double>(early) - late;
    const Eigen::Vector2f shift = static_cast<float>(between) * flow((found.A - A).cast<float>(), place.x(), place.y());
    for (std::uint32_t i = 0; i < track.anchor.size(); ++i) {
      track.anchor.x[i] += shift.x();
      track.anchor.y[i] += shift.y();
    }
    return place + shift;
  }
  track.anchor.clear();
  std::vector<float> x, y;
  warp(patch_, A, x, y);
  for (std::size_t i = 0; i < x.size(); ++i) track.anchor.add(x[i], y[i], 0.0F, patch_.on[i] != 0);
  return place;
}

/// Observes between the last batch's observations and `until` [µs], at the times of events near the track.
void Str::observe_between(const Track& track, const Batch& batch, const Eigen::Vector2f& place, const Matrix3& A,
                          std::int64_t reference, std::int64_t until) {
  constexpr std::ptrdiff_t kTried = 2000;  // events
  const auto interval = std::llround(1e6 * options_.interval);
  std::int64_t reported = microseconds(complete_);
  for (std::int64_t wanted = reported + interval; wanted + interval / 2 < until; wanted += interval) {
    auto event = std::ranges::lower_bound(batch.events, wanted, {}, &Event::t);
    const auto last = event + std::min(kTried, batch.events.end() - event);
    const Vector2 there = pixel_of(moved(place, A, 1e-6 * static_cast<double>(wanted - reference)));
    event = std::find_if(event, last,
                         [&](const Event& e) { return (Vector2(e.x, e.y) - there).norm() < options_.patch.radius; });
    if (event == last || event->t <= reported || event->t >= until) continue;
    reported = event->t;
    delayed_.add({track.id, seconds(reported),
                  pixel_of(moved(place, A, 1e-6 * static_cast<double>(reported - reference))), options_.sigma});
  }
}

void Str::observe(Track& track, const Eigen::Vector2f& ray, std::int64_t t) {
  track.ray = ray;
  track.t = t;
  track.pixel = pixel_of(ray);
  delayed_.add({track.id, seconds(t), track.pixel, options_.sigma});
}

Vector2 Str::pixel_of(const Eigen::Vector2f& ray) const {
  return camera_.project(Vector3(static_cast<double>(ray.x()), static_cast<double>(ray.y()), 1.0));
}

/// Adds tracks where there are too few: corners of the image of the last slice, compensated to its middle.
void Str::replenish(const Batch& batch, const Registration& registration) {
  const auto wanted = static_cast<std::size_t>(options_.tracks);
  if (tracks_.size() >= wanted) return;
  const double length = static_cast<double>(batch.to - batch.from);
  const std::int64_t middle = batch.to - static_cast<std::int64_t>(0.5 * options_.registration.slice * length);
  const EventCloud& late = registrar_.aligner().targets();
  EventCloud shifted = late;
  const auto offset = 1e-6F * static_cast<float>(middle - registration.reference);
  for (float& t : shifted.t) t -= offset;
  std::vector<float> x, y;
  warp(shifted, registration.A, x, y);
  std::vector<Event> image;
  const auto most = static_cast<std::size_t>(options_.detection.events);
  for (std::size_t i = late.size() > most ? late.size() - most : 0; i < late.size(); ++i) {
    const Vector2 pixel = pixel_of({x[i], y[i]});
    if (!camera_.contains(pixel)) continue;
    image.push_back({middle, static_cast<std::uint16_t>(std::lround(pixel.x())),
                     static_cast<std::uint16_t>(std::lround(pixel.y())), late.on[i] != 0});
  }
  std::vector<Vector2> taken;
  for (const Track& track : tracks_) taken.push_back(track.pixel);
  for (const Vector2& pixel :
       detect_features(options_.detection, image, camera_.width, camera_.height, taken, wanted - tracks_.size())) {
    const auto ideal = camera_.undistort(pixel);
    if (!ideal) continue;
    Track track{next_id_++, {}, 0, pixel};
    observe(track, camera_.pinhole.ray(*ideal).head<2>().cast<float>(), middle);
    tracks_.push_back(track);
  }
}

/// Tracks begin with their seeds, and are moved to the middle of the last slice.
void Str::start_seeds(const Batch& batch, const Registration& registration) {
  const double length = static_cast<double>(batch.to - batch.from);
  const std::int64_t middle = batch.to - static_cast<std::int64_t>(0.5 * options_.registration.slice * length);
  for (const TrackObservation& seed : seeds_.take(seconds(middle))) {
    const auto ideal = camera_.undistort(seed.pixel);
    if (!ideal || !camera_.contains(seed.pixel, options_.patch.border)) continue;
    Track track{seed.track, {}, 0, seed.pixel};
    const std::int64_t begin = microseconds(seed.t), t = std::max(begin, microseconds(complete_) + 1);
    if (t - begin > batch.to - batch.from) continue;  // there was no motion by which to move it
    const Eigen::Vector2f ray = camera_.pinhole.ray(*ideal).head<2>().cast<float>();
    observe(track, moved(ray, registration.A, 1e-6 * static_cast<double>(t - begin)), t);  // the earlier is published
    track.ray = moved(ray, registration.A, 1e-6 * static_cast<double>(middle - begin));
    track.t = middle;
    track.pixel = pixel_of(track.ray);
    tracks_.push_back(track);
  }
}

FeedbackNeeds Str::needs() const {
  const bool backend = options_.start == Options::Start::backend;
  return {backend, false, backend};
}

void Str::receive(const Feedback& feedback) {
  if (options_.start != Options::Start::backend) return;
  if (const auto A = expected_motion(feedback, options_.registration.model)) expected_ = A;
}

std::vector<std::string> Str::counts() const {
  const auto batches = [&](Registration::State state) { return registered_[index(static_cast<int>(state))]; };
  using State = Registration::State;
  return {
      fmt::format("batches: {} registered, {} with too few events, {} not converged, {} poor; {} times from nothing",
                  batches(State::good), batches(State::too_few_events), batches(State::not_converged),
                  batches(State::poor), grown_),
      fmt::format("{} tracks begun, {} alive at the end; ended: {} that fit no more, {} at the border, {} crowded",
                  next_id_, tracks_.size(), misfits_, left_, crowded_)};
}

}  // namespace evbench::str
