#include "frontends/str/dots/dots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/events/event_time.hpp"
#include "core/plugin/registration.hpp"

namespace evbench::str {
namespace {

const evbench::Registration<FrontEnd, Dots> dots_registration(
    "dots", "follows round dots by the events of their rims, found by registering batches of events", 3);

constexpr int kCell = 32;               // [px]
constexpr std::int64_t kListed = 1000;  // [µs] between two updates of the lists of near dots
constexpr double kBorder = 2.0;         // [px] of a rim from the image's border
constexpr double kApart = 1e-6;         // [s] between two observations of a track, at least

/// Velocity of a pixel under a batch's motion [px/s].
Vector2 image_velocity(const Camera& camera, const Matrix3& A, const Vector2& pixel) {
  constexpr double kStep = 1e-3;  // [s]
  const auto ideal = camera.undistort(pixel);
  if (!ideal) return Vector2::Zero();
  const Vector3 ray = camera.pinhole.ray(*ideal);
  const Vector3 later = ray - kStep * (A * ray);
  return (camera.project(later / later.z()) - pixel) / kStep;
}

}  // namespace

Dots::Dots(const Options& options, const FrontEndContext& context)
    : EventFrontEnd(context, "dots"),
      options_(options),
      batches_(options.batch, options.registration.slice, microseconds(range_.from)),
      registrar_(camera_, options.registration),
      columns_((camera_.width + kCell - 1) / kCell),
      rows_((camera_.height + kCell - 1) / kCell),
      near_(static_cast<std::size_t>(columns_ * rows_)),
      listed_(microseconds(range_.from)) {}

void Dots::take(std::span<const Event> events) {
  batches_.add(events);
  for (const Event& event : events) take(event);
}

void Dots::on_tick() {
  while (const auto batch = batches_.next(microseconds(clock_))) process(*batch);
}

/// Assigns an event to the dot whose rim is nearest, or to none.
void Dots::take(const Event& event) {
  if (event.t >= listed_ + kListed) {
    listed_ = event.t;
    list_near();
  }
  const Vector2 pixel(event.x, event.y);
  const double t = seconds(event.t);
  Track* owner = nullptr;
  double nearest = options_.dot.gate;
  for (const std::uint32_t i : near_[static_cast<std::size_t>((event.y / kCell) * columns_ + event.x / kCell)]) {
    const double distance = tracks_[i].dot.rim_distance(pixel, t);
    if (distance >= nearest || tracks_[i].lost) continue;
    nearest = distance;
    owner = &tracks_[i];
  }
  if (owner == nullptr) {
    free_.push_back(event);
  } else if (owner->dot.add(pixel, t)) {
    observe(*owner);
  }
}

void Dots::observe(Track& track) {
  const auto sighting = track.dot.locate();
  if (!sighting) return;
  const bool is_round = sighting->residual < options_.life.residual &&
                        std::abs(track.dot.radius() / track.radius - 1.0) < options_.life.radius;
  if (!is_round || leaves(track.dot, sighting->t)) {
    (is_round ? left_ : misfits_) += 1;
    track.lost = true;
    return;
  }
  TrackObservation z{track.id, sighting->t, sighting->centre, options_.sigma};
  const double published = std::max(track.dot.newest(), clock_) - options_.delay;  // published up to here
  if (z.t <= published) ++late_;
  z.t = std::max({z.t, published, track.reported + kApart});
  track.reported = z.t;
  delayed_.add(z);
}

bool Dots::leaves(const Dot& dot, double t) const { return !camera_.contains(dot.centre(t), dot.radius() + kBorder); }

void Dots::list_near() {
  for (auto& list : near_) list.clear();
  const double t = seconds(listed_);
  for (std::uint32_t i = 0; i < tracks_.size(); ++i) {
    const Dot& dot = tracks_[i].dot;
    const Vector2 c = dot.centre(t);
    const double reach = dot.radius() + options_.dot.gate + 1.0 + seconds(kListed) * dot.velocity().norm();
    const auto cell = [&](double x, int count) { return std::clamp(static_cast<int>(x / kCell), 0, count - 1); };
    for (int row = cell(c.y() - reach, rows_); row <= cell(c.y() + reach, rows_); ++row) {
      for (int column = cell(c.x() - reach, columns_); column <= cell(c.x() + reach, columns_); ++column) {
        near_[static_cast<std::size_t>(row * columns_ + column)].push_back(i);
      }
    }
  }
}

void Dots::process(const Batch& batch) {
  const Registration found = registrar_.align(batch, last_motion_);
  last_motion_ = found.good() ? std::optional(found.A) : std::nullopt;
  ++(found.good() ? registered_ : unregistered_);
  give_up(batch, found);
  const double end = seconds(batch.to);
  std::vector<PlaneMap::Seen> dots;
  for (const Track& track : tracks_) dots.push_back({track.id, track.dot.centre(end)});
  map_.update(dots);
  if (found.good()) find_new(batch, found);
  std::erase_if(free_, [&](const Event& event) { return event.t < batch.to; });
  listed_ = batch.to - kListed;  // the tracks have changed
}

/// Ends dots that have left the image, or that have no events although the image moves.
void Dots::give_up(const Batch& batch, const Registration& registration) {
  const double end = seconds(batch.to), duration = seconds(batch.to - batch.from);
  for (Track& track : tracks_) {
    if (track.dot.newest() > track.seen) track.way = 0.0;
    track.seen = track.dot.newest();
    if (registration.good()) {
      track.way += duration * image_velocity(camera_, registration.A, track.dot.centre(end)).norm();
    }
    if (track.lost) continue;
    const bool left = leaves(track.dot, end), starved = track.way > options_.life.starvation;
    left_ += left ? 1 : 0;
    starved_ += starved && !left ? 1 : 0;
    track.lost = left || starved;
  }
  for (const Track& track : tracks_) {
    if (!track.lost) continue;
    delayed_.end({track.id, clock_});
    if (options_.life.find_again) out_of_view_.insert(track.id);
  }
  std::erase_if(tracks_, [](const Track& track) { return track.lost; });
}

/// Finds new dots: clusters of unassigned events in the image that the registration compensates to the batch's end.
void Dots::find_new(const Batch& batch, const Registration& registration) {
  std::vector<Event> events;
  for (const Event& event : free_) {
    if (event.t >= batch.from && event.t < batch.to) events.push_back(event);
  }
  EventCloud cloud;
  make_cloud(events, registrar_.rays(), batch.to, cloud);
  std::vector<float> x, y;
  warp(cloud, registration.A, x, y);
  std::vector<Vector2> places;
  for (std::size_t i = 0; i < x.size(); ++i) {
    places.push_back(camera_.project(Vector3(static_cast<double>(x[i]), static_cast<double>(y[i]), 1.0)));
  }
  const double end = seconds(batch.to);
  for (const Circle& circle : find_circles(options_.segmentation, places, camera_.width, camera_.height)) {
    const bool taken = std::ranges::any_of(tracks_, [&](const Track& track) {
      return (track.dot.centre(end) - circle.centre).norm() < std::max(track.dot.radius(), circle.radius);
    });
    const Dot dot(options_.dot, circle, image_velocity(camera_, registration.A, circle.centre), end);
    if (taken || leaves(dot, end)) continue;
    const auto known = known_at(circle.centre);
    if (known) {
      out_of_view_.erase(*known);
      ++found_again_;
    }
    tracks_.push_back({known.value_or(next_id_), dot, circle.radius, end, 0.0, end});
    if (!known) ++next_id_;
  }
}

/// The dot out of view that is expected at a position; none where several are.
std::optional<TrackId> Dots::known_at(const Vector2& pixel) const {
  std::optional<TrackId> result;
  for (const TrackId id : out_of_view_) {
    const auto expected = map_.pixel(id);
    if (!expected || (*expected - pixel).norm() > options_.life.search) continue;
    if (result) return std::nullopt;
    result = id;
  }
  return result;
}

std::vector<std::string> Dots::counts() const {
  return {fmt::format("batches: {} registered, {} not", registered_, unregistered_),
          fmt::format("{} dots found, {} in view at the end; lost: {} at the border, {} that were no longer round, {} "
                      "without events; {} re-acquired",
                      next_id_, tracks_.size(), left_, misfits_, starved_, found_again_),
          fmt::format("{} observations came later than the delay", late_)};
}

}  // namespace evbench::str
