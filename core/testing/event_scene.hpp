#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "core/plugin/source.hpp"
#include "core/simulation/random.hpp"
#include "core/testing/event_list.hpp"

namespace evbench::testing {

/// A test source: events of a camera with 240 x 180 pixels that moves in front of a wall with outlines, at 2 m
/// distance. An outline consists of points, and a point emits an event when its image enters another pixel. Fast to
/// compute, and tests can add or remove events.
class EventScene : public Source {
 public:
  using Motion = std::function<SE3(double)>;  ///< T_world_camera at t [s]
  /// A closed line on the wall [m].
  using Outline = std::vector<Vector2>;

  static constexpr double kDistance = 2.0;  ///< [m], of the wall from the world's origin, along z

  EventScene(const Motion& motion, double duration, const std::vector<Outline>& outlines) : to_(duration) {
    camera_.width = 240;
    camera_.height = 180;
    camera_.pinhole = {200.0, 200.0, 119.5, 89.5};
    see(motion, points_of(outlines));
    std::vector<StampedPose> poses;
    for (int i = 0; i / 200.0 <= duration; ++i) poses.push_back({i / 200.0, motion(i / 200.0)});
    truth_ = PoseTrajectory(std::move(poses));
  }

  /// Random quadrangles on the wall.
  static std::vector<Outline> quadrangles(int count, std::uint64_t seed, double size = 0.2) {
    Random random(seed);
    std::vector<Outline> result;
    for (int i = 0; i < count; ++i) {
      const Vector2 centre = random.uniform2({-2.0, -1.5}, {2.0, 1.5});
      Outline outline;
      for (int k = 0; k < 4; ++k) {
        const double angle = 1.5708 * k + random.uniform(-0.5, 0.5), radius = size * random.uniform(0.4, 1.0);
        outline.push_back(centre + radius * Vector2(std::cos(angle), std::sin(angle)));
      }
      result.push_back(outline);
    }
    return result;
  }

  const Camera& camera() const override { return camera_; }
  TimeRange time_range() const override { return {0.0, to_}; }
  const PoseTrajectory& ground_truth() const override { return truth_; }
  std::unique_ptr<EventReader> all_events() const override {
    return std::make_unique<EventList>(list, camera_.width, camera_.height);
  }

  bool silence_is_known() const override { return silence_is_known_; }

  /// Makes it a recording that may continue after its last event.
  void cut_off() { silence_is_known_ = false; }

  /// Adds events, in any order.
  void add(const std::vector<Event>& more) {
    list.insert(list.end(), more.begin(), more.end());
    std::ranges::stable_sort(list, {}, &Event::t);
  }
  /// Removes the events between two times [s].
  void silence(double from, double to) {
    std::erase_if(list, [&](const Event& event) {
      const auto t = static_cast<double>(event.t);
      return t >= 1e6 * from && t < 1e6 * to;
    });
  }

  std::vector<Event> list;  ///< in time order, unless a test changes it

 private:
  static std::vector<Vector3> points_of(const std::vector<Outline>& outlines) {
    constexpr double kSpacing = 0.004;  // [m]: 0.4 px
    std::vector<Vector3> points;
    for (const Outline& outline : outlines) {
      for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vector2 &from = outline[i], &to = outline[(i + 1) % outline.size()];
        const double length = (to - from).norm();
        for (double s = 0.0; s < length; s += kSpacing) {
          const Vector2 p = from + (s / length) * (to - from);
          points.emplace_back(p.x(), p.y(), kDistance);
        }
      }
    }
    return points;
  }

  void see(const Motion& motion, const std::vector<Vector3>& points) {
    constexpr std::int64_t kStep = 2000;  // [µs]
    std::vector<int> pixel_of(points.size(), -1);
    for (std::int64_t t = 0; t <= static_cast<std::int64_t>(1e6 * to_); t += kStep) {
      const SE3 T_camera_world = motion(static_cast<double>(t) / 1e6).inverse();
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vector3 q = T_camera_world * points[i];
        int pixel = -1;
        if (q.z() > 0.1) {
          const Vector2 image = camera_.pinhole.project(q);
          const auto x = static_cast<int>(std::lround(image.x())), y = static_cast<int>(std::lround(image.y()));
          if (x >= 0 && y >= 0 && x < camera_.width && y < camera_.height) pixel = y * camera_.width + x;
        }
        if (pixel >= 0 && pixel_of[i] >= 0 && pixel != pixel_of[i]) {
          // A pseudo-random order within the step.
          const auto within = static_cast<std::int64_t>((i * 7919) % static_cast<std::size_t>(kStep));
          list.push_back({t + within, static_cast<std::uint16_t>(pixel % camera_.width),
                          static_cast<std::uint16_t>(pixel / camera_.width), i % 2 == 0});
        }
        pixel_of[i] = pixel;
      }
    }
    std::ranges::stable_sort(list, {}, &Event::t);
  }

  Camera camera_;
  double to_;
  bool silence_is_known_ = true;
  PoseTrajectory truth_;
};

/// Oscillates with a little rotation, like a hand-held camera in front of a wall.
inline SE3 swing(double t) {
  Vector6 twist;
  twist << 0.06 * std::sin(1.1 * t), 0.08 * std::sin(0.9 * t + 0.5) - 0.08 * std::sin(0.5), 0.05 * std::sin(1.3 * t),
      0.35 * std::sin(1.6 * t), 0.2 * std::sin(1.2 * t), 0.15 * std::sin(0.8 * t);
  return se3::exp(twist);
}

/// Distances of the observations from where the wall point of their track's first one is by then [px]; sorted.
inline std::vector<double> track_errors(const EventScene& source, const EventScene::Motion& motion,
                                        const std::vector<TrackObservation>& observations) {
  std::map<TrackId, Vector3> points;
  std::vector<double> errors;
  for (const TrackObservation& z : observations) {
    const SE3 T = motion(z.t);
    if (const auto point = points.find(z.track); point != points.end()) {
      errors.push_back((source.camera().project(T.inverse() * point->second) - z.pixel).norm());
    } else {
      const Vector3 ray = T.R() * source.camera().pinhole.ray(z.pixel);
      points.emplace(z.track, T.p + (EventScene::kDistance - T.p.z()) / ray.z() * ray);
    }
  }
  std::ranges::sort(errors);
  return errors;
}

}  // namespace evbench::testing
