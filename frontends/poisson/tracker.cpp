#include "frontends/poisson/tracker.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/events/event_time.hpp"

namespace evbench::poisson {
namespace {

constexpr std::array<int, 4> kSeen = {0, 1, 4, 5};  // components of the state that events depend on
constexpr double kSlow = 30.0;                      // [px/s] that motion may change by, however slow it is
constexpr double kTurning = 0.01, kGrowth = 0.001;  // [rad], [log scale] for each root of a pixel of way

/// Sum of logarithms, by few of them.
class LogSum {
 public:
  void add(double value) {
    product_ *= value;
    if (product_ > 1e100 || product_ < 1e-100) flush();
  }
  double value() {
    flush();
    return sum_;
  }

 private:
  void flush() {
    sum_ += std::log(product_);
    product_ = 1.0;
  }
  double sum_ = 0.0, product_ = 1.0;
};

double largest_deviation(const Matrix2& covariance) {
  const double mean = 0.5 * covariance.trace(), half = 0.5 * (covariance(0, 0) - covariance(1, 1));
  return std::sqrt(std::max(mean + std::hypot(half, covariance(0, 1)), 0.0));  // NaN stays
}

Vector2 direction_of(const Vector2& velocity) {
  const double speed = velocity.norm();
  return speed > 0.0 ? Vector2(velocity / speed) : Vector2::UnitX();
}

}  // namespace

Tracker::Tracker(const TrackerOptions& options, const Vector2& pixel, double at, const Vector2& velocity,
                 std::span<const Event> window)
    : options_(options),
      patch_(options.radius),
      t_(seconds(window.back().t)),
      position_(pixel + (t_ - at) * velocity),
      velocity_(velocity) {
  constexpr double kPlace = 0.22, kAngle = 0.01, kScale = 0.003;  // standard deviations [px], [rad], [log scale]
  constexpr double kLeastWay = 0.3;                               // [px]
  const double length = t_ - seconds(window.front().t);
  const Vector2 d = direction_of(velocity);
  patch_.move(d, std::max(velocity.norm() * length, kLeastWay), options.memory);
  for (const Event& event : window) {
    patch_.add(Vector2(event.x, event.y) + lag(velocity) - position(seconds(event.t)), event.on, d);
  }
  const double speed_sigma = 0.15 * velocity.norm() + 0.5 / std::max(length, 1e-6);
  P_.diagonal().head<2>().setConstant(kPlace * kPlace);
  P_.diagonal().segment<2>(2).setConstant(speed_sigma * speed_sigma);
  if (options.rotation) P_(4, 4) = kAngle * kAngle;
  if (options.scale) P_(5, 5) = kScale * kScale;
  last_ = {t_, position_, P_.topLeftCorner<2, 2>()};
}

double Tracker::deviation() const { return largest_deviation(P_.topLeftCorner<2, 2>()); }

/// How far edges are before their events. The patch is learnt and placed by both alike; without it a point would jump
/// when the motion turns back.
Vector2 Tracker::lag(const Vector2& velocity) const {
  return velocity.squaredNorm() > 0.0 ? Vector2(options_.lag * velocity.normalized()) : Vector2::Zero();
}

Vector2 Tracker::to_patch(const Vector2& direction) const {
  const double c = std::cos(angle_), s = std::sin(angle_);
  return {c * direction.x() + s * direction.y(), c * direction.y() - s * direction.x()};
}

void Tracker::push(std::span<const Event> events, std::vector<Observation>& observations) {
  if (events.empty()) return;
  // Most events are elsewhere; the point moves little meanwhile.
  const double t = seconds(events.back().t);
  const double near = options_.radius + 2.0 + velocity_.norm() * (t - seconds(events.front().t));
  const Vector2 centre = position(t);
  const auto x = static_cast<float>(centre.x()), y = static_cast<float>(centre.y());
  const auto square = static_cast<float>(near * near);
  for (const Event& event : events) {
    const float dx = event.x - x, dy = event.y - y;
    if (dx * dx + dy * dy < square) take(event, observations);
  }
}

void Tracker::take(const Event& event, std::vector<Observation>& observations) {
  const Vector2 pixel(event.x, event.y);
  const double t = seconds(event.t);
  if ((pixel - position(t)).squaredNorm() > options_.radius * options_.radius) return;
  waiting_.push_back({pixel, t, event.on});
  if (!is_due(t)) return;
  correct();
  if (!has_coming_) {
    remember();
  } else if (way_ >= options_.interval) {
    observations.push_back(observe());
  }
}

bool Tracker::is_due(double t) const {
  constexpr std::size_t kEnough = 60, kUsual = 15, kFew = 5;
  const double way = velocity_.norm() * (t - t_);
  const std::size_t count = waiting_.size();
  return count >= kEnough || (count >= kUsual && way > options_.step) || (count >= kFew && way > 3.0 * options_.step);
}

void Tracker::pass(double t, double waits, std::vector<Observation>& observations) {
  constexpr double kEnough = 15.0, kShare = 0.3;  // expected events; share of them
  while (has_coming_ && coming_.t < waits) {
    const bool is_newest = coming_.t >= t_;
    observations.push_back(observe());
    if (is_newest) has_coming_ = false;
  }
  // Fewer events than the motion would make: it has come to rest.
  const double expected = velocity_.norm() * (t - t_) * patch_.events_per_pixel();
  if (expected > kEnough && static_cast<double>(waiting_.size()) < kShare * expected) {
    t_ = t;
    velocity_.setZero();
    P_.block<2, 2>(2, 2) += kSlow * kSlow * Matrix2::Identity();
  }
}

void Tracker::expect(const Vector2& velocity, const Matrix2& covariance) {
  Eigen::SelfAdjointEigenSolver<Matrix2> solver;
  solver.computeDirect(P_.topLeftCorner<2, 2>());
  const double share = 1.0 - solver.eigenvalues()[0] / solver.eigenvalues()[1];  // 0 for a corner, 1 for an edge
  const Vector2 along = solver.eigenvectors().col(1);
  const Eigen::Matrix<double, 8, 1> column = P_.middleCols<2>(2) * along;
  const double variance = along.dot(covariance * along) / share;
  const Eigen::Matrix<double, 8, 1> gain = column / (along.dot(column.segment<2>(2)) + variance);
  const Eigen::Matrix<double, 8, 1> by = gain * along.dot(velocity - velocity_);
  if (!by.allFinite()) return;  // none are near
  shift(by);
  P_ -= gain * column.transpose();
  P_ = 0.5 * (P_ + P_.transpose()).eval();
}

void Tracker::shift(const Eigen::Matrix<double, 8, 1>& by) {
  position_ += by.head<2>();
  velocity_ += by.segment<2>(2);
  angle_ += by[4];
  log_scale_ += by[5];
  coming_.position += by.tail<2>();
}

/// White noise on acceleration. Its density follows from the way, so that slow and fast motion are alike.
void Tracker::predict(double t) {
  const double dt = t - t_, speed = velocity_.norm() + kSlow;
  const double q = options_.acceleration * options_.acceleration * speed * speed * speed;
  position_ = position(t);
  t_ = t;
  Covariance F = Covariance::Identity();
  F.block<2, 2>(0, 2).diagonal().setConstant(dt);
  P_ = F * P_ * F.transpose();
  P_.block<2, 2>(0, 0).diagonal().array() += q * dt * dt * dt / 3.0;
  P_.block<2, 2>(0, 2).diagonal().array() += q * dt * dt / 2.0;
  P_.block<2, 2>(2, 0).diagonal().array() += q * dt * dt / 2.0;
  P_.block<2, 2>(2, 2).diagonal().array() += q * dt;
  if (options_.rotation) P_(4, 4) += kTurning * kTurning * speed * dt;
  if (options_.scale) P_(5, 5) += kGrowth * kGrowth * speed * dt;
}

/// Of the state plus a correction; before lag, as edges are seen.
Tracker::Place Tracker::place(const Vector4& delta) const {
  const double scale = std::exp(-log_scale_ - delta[3]), angle = angle_ + delta[2];
  return {scale * std::cos(angle), scale * std::sin(angle), position_ + delta.head<2>() - lag(velocity_), velocity_,
          t_};
}

/// The derivatives by the state of what has these by the place u on the patch: ∂u/∂position = −R'/scale,
/// ∂u/∂angle = (u_y, −u_x), ∂u/∂log scale = −u.
Tracker::Vector4 Tracker::by_state(const Place& place, double x, double y, double turning, double growing) {
  return {place.s * y - place.c * x, -place.s * x - place.c * y, turning, -growing};
}

void Tracker::correct() {
  constexpr int kIterations = 3;
  constexpr double kSmall = 0.01;  // [px] of a last step
  const Vector2 from = position_;
  predict(waiting_.back().t);
  patch_.look(to_patch(direction_of(velocity_)), options_.shares);

  Matrix4 P;
  Eigen::Matrix<double, 8, 4> columns;
  for (int j = 0; j < 4; ++j) {
    columns.col(j) = P_.col(kSeen[index(j)]);
    for (int i = 0; i < 4; ++i) P(i, j) = P_(kSeen[index(i)], kSeen[index(j)]);
  }
  P.diagonal().array() += 1e-9;
  const Matrix4 prior = P.inverse();
  if (!has_slope_) slope_ = patch_.mean_slope();
  has_slope_ = true;
  const auto count = static_cast<double>(waiting_.size());
  Vector4 delta = Vector4::Zero();
  Matrix4 H = Matrix4::Zero();
  for (int k = 0; k < kIterations; ++k) {
    const Place place = this->place(delta);
    Vector4 gradient = -count * by_state(place, slope_.x, slope_.y, slope_.turning, slope_.growing);
    H.setZero();
    for (const Waiting& event : waiting_) {
      const Vector2 u = place.of(event);
      const Patch::Rate rate = patch_.rate(u, event.on);
      const double gx = rate.x / rate.value, gy = rate.y / rate.value;
      const Vector4 J = by_state(place, gx, gy, gx * u.y() - gy * u.x(), gx * u.x() + gy * u.y());
      gradient += J;
      H += J * J.transpose();
    }
    const Vector4 step = (H + prior).ldlt().solve(gradient - prior * delta);
    if (!step.allFinite()) break;
    delta += step;
    if (step.head<2>().squaredNorm() < kSmall * kSmall) break;
  }
  const double highest = log_likelihood(place(delta));

  // The outer products take the patch's noise for structure; the curvature of the likelihood does not.
  const Matrix2 outer = H.topLeftCorner<2, 2>() + 1e-9 * Matrix2::Identity();
  const Matrix2 L = outer.llt().matrixL(), L_seen = information(delta, highest).llt().matrixL();
  Matrix4 D = Matrix4::Identity();
  D.topLeftCorner<2, 2>() = L_seen * L.inverse();
  H = options_.independence * D * H * D.transpose();

  const Eigen::Matrix<double, 8, 1> by_all = columns * (prior * delta);
  const Matrix4 weight = (Matrix4::Identity() + H * P).inverse() * H;
  P_ -= columns * weight * columns.transpose();
  P_ = 0.5 * (P_ + P_.transpose()).eval();
  shift(by_all);
  way_ += (position_ - from).norm();
  after_.insert(after_.end(), waiting_.begin(), waiting_.end());
  waiting_.clear();
}

double Tracker::log_likelihood(const Place& place) const {
  LogSum sum;
  for (const Waiting& event : waiting_) sum.add(patch_.rate(place.of(event), event.on).value);
  return sum.value();
}

/// About the position: minus the second derivatives of the log likelihood, by differences along three directions.
/// [1/px²]
Matrix2 Tracker::information(const Vector4& delta, double highest) const {
  constexpr double kAside = 1.0, kLeast = 1e-3;  // [px], [1/px²]
  Matrix2 sum = Matrix2::Zero();
  double trace = 0.0;
  for (int k = 0; k < 3; ++k) {
    const Vector2 e(std::cos(k * M_PI / 3.0), std::sin(k * M_PI / 3.0));
    Place forward = place(delta), backward = forward;
    forward.position += kAside * e;
    backward.position -= kAside * e;
    const double along = (2.0 * highest - log_likelihood(forward) - log_likelihood(backward)) / (kAside * kAside);
    sum += along * e * e.transpose();
    trace += 2.0 / 3.0 * along;
  }
  // Σ e'He ee' = 3/8 (trace I + 2 H), as the directions are spread evenly.
  Eigen::SelfAdjointEigenSolver<Matrix2> solver;
  solver.computeDirect(4.0 / 3.0 * sum - 0.5 * trace * Matrix2::Identity());
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(kLeast).asDiagonal() * solver.eigenvectors().transpose();
}

/// The coming observation is made; the present state becomes the next one.
Tracker::Observation Tracker::observe() {
  constexpr double kNewest = 0.3;    // weight in running means
  constexpr double kLeastWay = 0.1;  // [px] that shows a direction
  Observation z = {coming_.t, coming_.position, P_.bottomRightCorner<2, 2>()};
  deviation_ += kNewest * (largest_deviation(z.covariance) - deviation_);
  z.deviation = deviation_;
  if (z.t > last_.t && (z.position - last_.position).norm() > kLeastWay) {
    learn(last_, z);
    last_ = z;
    before_.clear();
  }
  remember();
  return z;
}

/// The present state's position is observed next.
void Tracker::remember() {
  constexpr std::ptrdiff_t kMostEvents = 20'000;  // of a point that hardly moves
  before_.insert(before_.end(), after_.begin(), after_.end());
  if (std::ssize(before_) > kMostEvents) before_.erase(before_.begin(), before_.end() - kMostEvents);
  after_.clear();
  coming_ = {.t = t_, .position = position_};
  P_.middleRows<2>(6) = P_.middleRows<2>(0).eval();
  P_.middleCols<2>(6) = P_.middleCols<2>(0).eval();
  way_ = 0.0;
  has_coming_ = true;
}

/// Adds the events between two observations to the patch.
void Tracker::learn(const Observation& from, const Observation& to) {
  const Vector2 moved = to.position - from.position, velocity = moved / (to.t - from.t);
  const double scale = std::exp(-log_scale_);
  const Vector2 d = to_patch(direction_of(moved));
  const Place place{scale * std::cos(angle_), scale * std::sin(angle_), to.position - lag(velocity), velocity, to.t};
  patch_.move(d, scale * moved.norm(), options_.memory);
  for (const Waiting& event : before_) patch_.add(place.of(event), event.on, d);
  has_slope_ = false;
}

}  // namespace evbench::poisson
