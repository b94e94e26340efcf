#include "frontends/str/motion/motion_tracks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "core/events/event_time.hpp"
#include "core/plugin/registration.hpp"

namespace evbench::str {
namespace {

const evbench::Registration<FrontEnd, MotionTracks> motion_registration(
    "str_motion", "registers batches of events as point clouds; tracks are points that the motion of the image carries",
    3);

std::pair<Batch, Batch> halves(const Batch& batch) {
  const std::int64_t middle = batch.from + (batch.to - batch.from) / 2;
  const auto early =
      static_cast<std::size_t>(std::ranges::lower_bound(batch.events, middle, {}, &Event::t) - batch.events.begin());
  return {{batch.events.first(early), batch.from, middle}, {batch.events.subspan(early), middle, batch.to}};
}

}  // namespace

MotionTracks::MotionTracks(const Options& options, const FrontEndContext& context)
    : EventFrontEnd(context, "str_motion"),
      options_(options),
      batches_(options.batch, 0.0, microseconds(range_.from)),
      registrar_(camera_, options.registration),
      complete_(range_.from) {}

void MotionTracks::on_tick() {
  while (const auto batch = batches_.next(microseconds(clock_))) process(*batch);
}

void MotionTracks::process(const Batch& batch) {
  const std::size_t of_one_at_rest = 2 * static_cast<std::size_t>(options_.registration.least_events);
  const Span span{seconds(batch.from - 1), seconds(batch.to - 1)};  // events up to here, these included
  if (batch.events.size() < of_one_at_rest) {
    ++still_;
    batches_.expect(0.0);
    move({span, Matrix3::Zero()});
    return;
  }
  const Registration found = registrar_.align(batch, last_ ? std::optional(last_->A) : std::nullopt);
  const bool divisible = seconds(batch.to - batch.from) >= 2.0 * options_.shortest_batch;
  if (found.good() || (!divisible && found.alignment.converged && found.alignment.fit >= options_.shortest_fit)) {
    ++registered_;
    batches_.expect(found.motion / seconds(batch.to - batch.from));
    move({span, found.A});
  } else if (divisible) {
    ++divided_;
    const auto [early, late] = halves(batch);
    process(early);
    process(late);
  } else {
    ++unregistered_;
    batches_.expect(0.0);
    unknown_.push_back(span);
    if (!last_ || span.to - unknown_.front().from > options_.patience) interrupt(span.to);
  }
}

/// Moves the points through the spans of unknown motion and then to the end of a span of known motion.
void MotionTracks::move(const Motion& motion) {
  for (const Span& span : unknown_) {
    const double share = (span.middle() - last_->span.middle()) / (motion.span.middle() - last_->span.middle());
    carry_on({span, last_->A + share * (motion.A - last_->A)});
  }
  unknown_.clear();
  carry_on(motion);
  last_ = motion;
  complete_ = motion.span.to;
  replenish();
}

void MotionTracks::carry_on(const Motion& motion) {
  const Matrix3 later = Matrix3(-(motion.span.to - motion.span.from) * motion.A).exp();
  std::vector<Point> alive;
  for (const Point& point : points_) {
    const Vector3 ray = later * point.ray;
    if (ray.z() > 0.0 && camera_.contains(camera_.project(ray))) {
      alive.push_back({point.id, ray / ray.z()});
      observe(alive.back(), motion.span.to);
    } else {
      delayed_.end({point.id, motion.span.to});
    }
  }
  points_ = std::move(alive);
}

/// Ends all points: the motion has been unknown for too long.
void MotionTracks::interrupt(double t) {
  interrupted_ += points_.empty() ? 0 : 1;
  for (const Point& point : points_) delayed_.end({point.id, t});
  points_.clear();
  unknown_.clear();
  last_.reset();
  complete_ = t;
}

/// Adds points at the grid positions that no point is near to.
void MotionTracks::replenish() {
  std::vector<Vector2> taken;
  for (const Point& point : points_) taken.push_back(camera_.project(point.ray));
  for (double y = 0.5 * options_.spacing; y < camera_.height; y += options_.spacing) {
    for (double x = 0.5 * options_.spacing; x < camera_.width; x += options_.spacing) {
      const Vector2 pixel(x, y);
      const bool near = std::ranges::any_of(
          taken, [&](const Vector2& other) { return (other - pixel).norm() < 0.5 * options_.spacing; });
      const auto ideal = near ? std::nullopt : camera_.undistort(pixel);
      if (!ideal) continue;
      points_.push_back({next_id_++, camera_.pinhole.ray(*ideal)});
      observe(points_.back(), complete_);
    }
  }
}

void MotionTracks::observe(const Point& point, double t) {
  delayed_.add({point.id, t, camera_.project(point.ray), options_.sigma});
}

std::vector<std::string> MotionTracks::counts() const {
  return {fmt::format("batches: {} registered, {} stationary, {} without a motion; {} divided into halves", registered_,
                      still_, unregistered_, divided_),
          fmt::format("{} points begun, {} in view at the end; {} times all ended, as there was no motion", next_id_,
                      points_.size(), interrupted_)};
}

}  // namespace evbench::str
