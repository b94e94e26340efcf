#include "frontends/poisson/tracker.hpp"

#include <functional>

#include "core/events/event_time.hpp"
#include "core/simulation/random.hpp"
#include "core/testing/catch2.hpp"
#include "frontends/poisson/contrast.hpp"

using namespace evbench;
using namespace evbench::poisson;

namespace {

/// A piece of an edge, with its normal towards the bright side.
struct EdgePoint {
  Vector2 place, normal;
};

/// A line of points, a third of a pixel apart.
void add_line(std::vector<EdgePoint>& points, const Vector2& from, const Vector2& to) {
  const Vector2 along = to - from;
  const Vector2 normal = Vector2(-along.y(), along.x()).normalized();
  const int count = static_cast<int>(3.0 * along.norm());
  for (int i = 0; i < count; ++i) points.push_back({from + along * i / count, normal});
}

std::vector<EdgePoint> corner() {
  std::vector<EdgePoint> points;
  add_line(points, {-14.0, 1.0}, {0.0, 0.0});
  add_line(points, {0.0, 0.0}, {3.0, 14.0});
  add_line(points, {-8.0, -9.0}, {8.0, -6.0});
  return points;
}

std::vector<EdgePoint> edge() {
  std::vector<EdgePoint> points;
  add_line(points, {-40.0, -10.0}, {40.0, 10.0});
  return points;
}

struct Pose {
  Vector2 position;
  double angle = 0.0, scale = 1.0;
};
using Motion = std::function<Pose(double)>;

/// An event when a point goes from one pixel to another, at one of them, of the polarity that its edge has then.
std::vector<Event> events_of(const std::vector<EdgePoint>& points, const Motion& motion, double duration) {
  constexpr double kStep = 2e-4;  // [s]
  const auto place = [&](const EdgePoint& p, double t) -> Vector2 {
    const Pose pose = motion(t);
    return pose.position + pose.scale * (Eigen::Rotation2Dd(pose.angle) * p.place);
  };
  std::vector<Event> events;
  Random random(3);
  for (double t = kStep; t < duration; t += kStep) {
    for (const EdgePoint& p : points) {
      const Vector2 before = place(p, t - kStep), now = place(p, t);
      if ((before.array().round() == now.array().round()).all()) continue;
      const Vector2 normal = Eigen::Rotation2Dd(motion(t).angle) * p.normal;
      const Vector2 pixel = (random.uniform(0.0, 1.0) < 0.5 ? before : now).array().round();
      events.push_back({.t = microseconds(t - random.uniform(0.0, kStep)),
                        .x = static_cast<std::uint16_t>(pixel.x()),
                        .y = static_cast<std::uint16_t>(pixel.y()),
                        .on = normal.dot(now - before) < 0.0});
    }
  }
  std::ranges::stable_sort(events, {}, &Event::t);
  return events;
}

struct Followed {
  std::vector<Tracker::Observation> observations;
  Tracker tracker;
};
/// Starts with the first 100 events, as a front-end does.
Followed follow(const std::vector<EdgePoint>& points, const Motion& motion, double duration,
                TrackerOptions options = {}) {
  options.lag = 0.0;  // these events are where the edges are
  std::vector<Event> events = events_of(points, motion, duration);
  const std::span<const Event> all(events);
  const auto near = [&](const Event& event) {
    return (Vector2(event.x, event.y) - motion(0.0).position).norm() < options.radius;
  };
  std::vector<Event> window;
  std::size_t first = 0;
  for (; window.size() < 100; ++first) {
    if (near(all[first])) window.push_back(all[first]);
  }
  const double end = seconds(window.back().t);
  Followed result{{},
                  Tracker(options, motion(end).position, end,
                          sharpest_velocity(window, motion(0.5 * end).position, options.radius), window)};
  for (double t = end; t < duration; t += 0.005) {
    const auto from = all.begin() + static_cast<std::ptrdiff_t>(first);
    const auto to = std::ranges::upper_bound(from, all.end(), microseconds(t + 0.005), {}, &Event::t);
    result.tracker.push({from, to}, result.observations);
    first = static_cast<std::size_t>(to - all.begin());
    result.tracker.pass(t + 0.005, t - 0.02, result.observations);
  }
  return result;
}

double rms_error(const std::vector<Tracker::Observation>& observations, const Motion& motion) {
  double sum = 0.0;
  for (const auto& z : observations) sum += (z.position - motion(z.t).position).squaredNorm();
  return std::sqrt(sum / static_cast<double>(observations.size()));
}

Pose straight(double t) { return {Vector2(60.0 + 90.0 * t, 80.0 - 40.0 * t)}; }
Pose swinging(double t) { return {Vector2(90.0 + 25.0 * std::sin(6.0 * t), 80.0 + 15.0 * std::sin(4.0 * t))}; }

}  // namespace

TEST_CASE("The sharpest velocity is that of the events' pattern") {
  std::vector<Event> events = events_of(corner(), straight, 0.04);
  std::erase_if(events,
                [](const Event& event) { return (Vector2(event.x, event.y) - straight(0.02).position).norm() > 15.0; });
  const Vector2 velocity = sharpest_velocity(events, straight(0.02).position, 15.0);
  CHECK((velocity - Vector2(90.0, -40.0)).norm() < 15.0);
  CHECK(sharpest_velocity({}, {}, 15.0).norm() == 0.0);
}

TEST_CASE("A corner is followed to a fraction of a pixel, about one observation a pixel, also when it turns back") {
  for (const Motion& motion : {Motion(straight), Motion(swinging)}) {
    const Followed followed = follow(corner(), motion, 1.0);
    double way = 0.0;
    for (double t = 0.0; t < 1.0; t += 0.001) way += (motion(t + 0.001).position - motion(t).position).norm();
    CHECK(rms_error(followed.observations, motion) < 0.5);
    CHECK(static_cast<double>(followed.observations.size()) > 0.5 * way);
    CHECK(static_cast<double>(followed.observations.size()) < 2.0 * way);
    CHECK(followed.tracker.observed_deviation() < 0.4);
  }
}

TEST_CASE("A corner that turns and grows is followed, and is not with neither in the state") {
  const Motion motion = [](double t) {
    Pose pose = straight(t);
    pose.angle = 0.5 * t;
    pose.scale = 1.0 + 0.1 * t;
    return pose;
  };
  TrackerOptions rigid;
  rigid.rotation = rigid.scale = false;
  const double error = rms_error(follow(corner(), motion, 1.0).observations, motion);
  CHECK(error < 0.6);
  CHECK(rms_error(follow(corner(), motion, 1.0, rigid).observations, motion) > 1.5 * error);
}

TEST_CASE("A position is less certain along an edge than across it, and than a corner's") {
  const Motion across = [](double t) { return Pose{Vector2(60.0 + 5.0 * t, 80.0 - 60.0 * t)}; };
  const Followed followed = follow(edge(), across, 0.6);
  REQUIRE(followed.observations.size() > 10);
  const Vector2 along = Vector2(4.0, 1.0).normalized(), normal(-along.y(), along.x());
  const Matrix2 covariance = followed.observations.back().covariance;
  const double sigma_along = std::sqrt(along.dot(covariance * along));
  const double sigma_across = std::sqrt(normal.dot(covariance * normal));
  CHECK(sigma_along > sigma_across);
  CHECK(sigma_across < 0.4);
  CHECK(followed.tracker.observed_deviation() > 2.0 * follow(corner(), across, 0.6).tracker.observed_deviation());
}

TEST_CASE("A velocity that is expected decides along an edge, and says little across it") {
  const Motion across = [](double t) { return Pose{Vector2(60.0 + 5.0 * t, 80.0 - 60.0 * t)}; };
  const Vector2 along = Vector2(4.0, 1.0).normalized(), normal(-along.y(), along.x());
  const auto moved = [](Tracker tracker, const Vector2& by, double sigma) {
    const Vector2 before = tracker.velocity();
    tracker.expect(before + by, sigma * sigma * Matrix2::Identity());
    return Vector2(tracker.velocity() - before);
  };
  const Followed of_edge = follow(edge(), across, 0.6);
  CHECK(moved(of_edge.tracker, 20.0 * along, 1.0).dot(along) > 15.0);
  CHECK(std::abs(moved(of_edge.tracker, 20.0 * normal, 1.0).dot(normal)) < 5.0);
  CHECK(moved(of_edge.tracker, 20.0 * along, 1000.0).norm() < 0.1);  // it is not certain enough
  CHECK(moved(of_edge.tracker, {NAN, 0.0}, 1.0).norm() == 0.0);
}

TEST_CASE("A tracker rests when its events cease, and goes on") {
  const Motion halting = [](double t) { return straight(t < 0.4 ? t : std::max(0.4, t - 0.5)); };
  const Followed still = follow(corner(), halting, 0.8);
  CHECK(still.tracker.velocity().norm() < 10.0);
  CHECK((still.tracker.position(0.8) - halting(0.8).position).norm() < 2.0);
  const Followed moving = follow(corner(), halting, 1.4);
  CHECK((moving.tracker.position(1.4) - halting(1.4).position).norm() < 2.0);
}
