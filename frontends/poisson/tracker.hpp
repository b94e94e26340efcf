#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/events/event.hpp"
#include "core/geometry/types.hpp"
#include "frontends/poisson/options.hpp"
#include "frontends/poisson/patch.hpp"

namespace evbench::poisson {

/// Follows a point by the likelihood of the events around it.
///
/// Events are a Poisson process whose rate the patch tells (Patch). The state is the point's position and velocity, and
/// the patch's angle and scale; it is predicted with constant velocity, as by a Kalman filter. As soon as the point
/// should have moved by about half a pixel, the events since then, each at its own time, correct the state: to the
/// maximum of their log likelihood and the prediction's, by Fisher scoring. Each event is used once. The information
/// that the events give about the position is how their log likelihood falls around the maximum: little along an edge.
///
/// The position of an earlier time is part of the state as well, until the point has moved on by a pixel: so it is
/// smoothed by what came after it, before it is observed, and before its events are added to the patch.
class Tracker {
 public:
  struct Observation {
    double t = 0.0;                            ///< [s]
    Vector2 position = Vector2::Zero();        ///< [px]
    Matrix2 covariance = Matrix2::Identity();  ///< [px²]
    double deviation = 0.0;                    ///< along its least known direction, a running mean [px]
  };

  /// The point is at `pixel` at time `at` [s] and moves with `velocity` [px/s]. `window`: events around it, in time
  /// order and at least two, that its patch is made of.
  Tracker(const TrackerOptions& options, const Vector2& pixel, double at, const Vector2& velocity,
          std::span<const Event> window);

  /// Takes the next events, in time order, those around the point. Appends observations.
  void push(std::span<const Event> events, std::vector<Observation>& observations);

  /// Time has passed until t, and all events up to there have been taken. No observation of a time before `waits` will
  /// follow: those that wait since before are appended now.
  void pass(double t, double waits, std::vector<Observation>& observations);

  /// Takes a velocity [px/s] that is expected here, with its covariance, as a measurement, along the direction in which
  /// the position is least known. Its variance grows to infinity as all directions are known alike.
  void expect(const Vector2& velocity, const Matrix2& covariance);

  Vector2 position(double t) const { return position_ + (t - t_) * velocity_; }
  const Vector2& velocity() const { return velocity_; }
  Matrix2 velocity_covariance() const { return P_.block<2, 2>(2, 2); }
  double newest() const { return t_; }                      ///< [s] time of the newest correction
  double deviation() const;                                 ///< of the position, along its least known direction [px]
  double observed_deviation() const { return deviation_; }  ///< the same of observations, a running mean

 private:
  using Covariance = Eigen::Matrix<double, 8, 8>;  // position, velocity, angle, log scale, the earlier position
  using Matrix4 = Eigen::Matrix<double, 4, 4>;
  using Vector4 = Eigen::Matrix<double, 4, 1>;  // position, angle, log scale: what events depend on

  /// An event that waits.
  struct Waiting {
    Vector2 pixel;
    double t;
    bool on;
  };
  /// From the image to the patch.
  struct Place {
    double c, s;
    Vector2 position, velocity;
    double t;
    Vector2 of(const Waiting& event) const {
      const Vector2 x = event.pixel - position - (event.t - t) * velocity;
      return {c * x.x() + s * x.y(), c * x.y() - s * x.x()};
    }
  };
  Place place(const Vector4& delta) const;
  static Vector4 by_state(const Place& place, double x, double y, double turning, double growing);
  Vector2 lag(const Vector2& velocity) const;
  Vector2 to_patch(const Vector2& direction) const;
  bool is_due(double t) const;
  void take(const Event& event, std::vector<Observation>& observations);
  void shift(const Eigen::Matrix<double, 8, 1>& by);
  void predict(double t);
  void correct();
  double log_likelihood(const Place& place) const;
  Matrix2 information(const Vector4& delta, double highest) const;
  Observation observe();
  void remember();
  void learn(const Observation& from, const Observation& to);

  TrackerOptions options_;
  Patch patch_;
  double t_;  ///< [s] of the state
  Vector2 position_, velocity_;
  double angle_ = 0.0, log_scale_ = 0.0;
  Covariance P_ = Covariance::Zero();
  Observation last_, coming_;  ///< the last one that was made; the earlier position of the state
  bool has_coming_ = false;
  Patch::Slope slope_;  ///< of the patch, since it learnt last
  bool has_slope_ = false;
  std::vector<Waiting> waiting_;         ///< events since the state
  std::vector<Waiting> before_, after_;  ///< those from the last observation to the coming one, and since then
  double way_ = 0.0;                     ///< [px] since the coming one
  double deviation_ = 0.1;               ///< [px]
};

}  // namespace evbench::poisson
