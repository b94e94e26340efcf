#include "core/smoother/testing/drawn_problem.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/motion/wnoa.hpp"
#include "core/smoother/factors.hpp"

namespace evbench::smoother::testing {
namespace {

constexpr int kAlive = 24;
constexpr int kLife = 20;   ///< intervals in which a landmark is observed
constexpr int kEnters = 5;  ///< the landmark enters with this observation
constexpr double kLandmarkSigma = 0.1;
constexpr int kWidth = 240, kHeight = 180;

PinholeCamera camera() { return {200.0, 200.0, 119.5, 89.5}; }

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

DrawnProblem::DrawnProblem(const DrawnOptions& options, std::uint64_t seed)
    : options_(options), random_(seed), qc_(Vector6::Constant(options.qc)) {
  pose_prior_.sigma.setConstant(1e-5);  // tight: otherwise the error of the first pose would dominate
  velocity_prior_.velocity << 0.0, 0.0, 0.0, 0.8, 0.0, 0.1;
  velocity_prior_.sigma.setConstant(0.05);
  draw_trajectory();
  for (int slot = 0; slot < kAlive; ++slot) {
    const int first_end = kEnters + slot * (kLife - kEnters) / kAlive;  // staggered
    draw_landmark(1, first_end);
    for (int first = first_end + 1; first < kStates; first += kLife) draw_landmark(first, first + kLife - 1);
  }
  if (options_.gauge == DrawnOptions::Gauge::scale_anchor) draw_anchor();
}

Vector3 DrawnProblem::normal3(double sigma) {
  Vector3 v;
  for (double& component : v) component = sigma * random_.normal();
  return v;
}

Vector6 DrawnProblem::normal6(double sigma) {
  Vector6 v;
  for (double& component : v) component = sigma * random_.normal();
  return v;
}

/// In each interval the local variable (ξ, ξ') of the prior is a Gauss-Markov chain from (0, ϖ_{k−1}).
void DrawnProblem::draw_trajectory() {
  const Matrix12 phi = wnoa::transition(kStep);
  const Matrix12 root = wnoa::process_covariance(kStep, qc_).llt().matrixL();
  ControlState start;
  start.T = pose_prior_.T * se3::exp(normal6(pose_prior_.sigma[0]));
  start.velocity = velocity_prior_.velocity + normal6(velocity_prior_.sigma[0]);
  truth_.push_back(start);
  for (int k = 1; k < kStates; ++k) {
    Vector12 local = Vector12::Zero();
    local.tail<6>() = start.velocity;
    for (int step = 0; step < kSteps; ++step) {
      Vector12 noise;
      noise << normal6(1.0), normal6(1.0);
      local = phi * local + root * noise;
      const Vector6 xi = local.head<6>();
      const double t = kStep * static_cast<double>(truth_.size());
      truth_.push_back({t, start.T * se3::exp(xi), se3::right_jacobian(xi) * local.tail<6>()});
    }
    start = truth_.back();
  }
}

/// A point somewhere in the image of interval `first`, observed until it leaves the image or to interval `last`.
void DrawnProblem::draw_landmark(int first, int last) {
  const Vector2 pixel = random_.uniform2({0.0, 0.0}, {kWidth, kHeight});
  const double depth = random_.uniform(2.0, 4.0);
  Landmark landmark;
  landmark.first = first;
  landmark.position = truth((first - 1) * kSteps).T * (depth * camera().ray(pixel));
  if (options_.gauge == DrawnOptions::Gauge::landmark_priors) {
    landmark.prior = {landmark.position + normal3(kLandmarkSigma), kLandmarkSigma};
    landmark.guess = landmark.prior.position;
  } else {
    landmark.guess = landmark.position + normal3(kLandmarkSigma);
  }
  const bool at_states = options_.observed == DrawnOptions::Observed::at_states;
  const int step = at_states ? kSteps : 1 + static_cast<int>(landmarks_.size()) % kSteps;
  for (int k = first; k <= std::min(last, kStates - 1); ++k) {
    const double t = truth((k - 1) * kSteps + step).t;
    const SE3 T = GpInterval(truth((k - 1) * kSteps), truth(k * kSteps)).pose(t);
    const Vector2 seen = camera().project(T.inverse() * landmark.position);
    if (seen.x() < 0.0 || seen.y() < 0.0 || seen.x() > kWidth || seen.y() > kHeight) break;
    const double sigma = options_.noise_scale * options_.pixel_sigma;
    Vector2 noise = sigma * random_.normal2();
    Whitening whitening = 1.0 / options_.pixel_sigma;
    if (options_.edge != 1.0) {
      const Eigen::Rotation2Dd R(static_cast<double>(landmarks_.size()));  // [rad]
      const Matrix2 stretched = R * Vector2(options_.edge, 1.0).asDiagonal() * R.inverse();
      noise = stretched * noise;
      whitening = PixelNoise(options_.pixel_sigma).mapped(stretched).whitening();
    }
    landmark.observations.push_back({t, seen + noise, whitening});
  }
  if (landmark.observations.size() >= kEnters) landmarks_.push_back(landmark);
}

/// The engine anchors the scale of the guesses: it has to be the true one, but for a deviation of the anchor's sigma.
void DrawnProblem::draw_anchor() {
  const double drawn = random_.normal();
  for (std::size_t j = 0; j < landmarks_.size(); ++j) {
    if (landmarks_[j].first == 1) anchors_.push_back(static_cast<int>(j));
  }
  const Vector3 origin = pose_prior_.T.p;
  for (int i = 0; i < 20; ++i) {
    FactorGraph graph;
    for (const Landmark& landmark : landmarks_) graph.add_landmark(landmark.guess);
    graph.anchor_scale(origin, anchors_);
    for (std::size_t j = 0; j < landmarks_.size(); ++j) graph.landmarks[j].position = landmarks_[j].position;
    const double excess = graph.anchor.sigma * (residual(graph.anchor, graph) + drawn);
    for (const int j : anchors_) {
      landmarks_[at(j)].guess = origin + std::exp(excess) * (landmarks_[at(j)].guess - origin);
    }
  }
}

Smoother DrawnProblem::solve_incrementally(const SmootherOptions& engine_options) const {
  Smoother engine(camera(), qc_, RobustLoss(), engine_options);
  for (const Landmark& landmark : landmarks_) engine.add_landmark(landmark.guess, landmark.prior);
  engine.add_state({0.0, pose_prior_.T, velocity_prior_.velocity});
  engine.add_pose_prior(pose_prior_);
  engine.add_velocity_prior(velocity_prior_);
  if (!anchors_.empty()) engine.anchor_scale(pose_prior_.T.p, anchors_);
  engine.update();
  for (int k = 1; k < kStates; ++k) {
    engine.add_state(extrapolate(engine.graph().states.back(), truth(k * kSteps).t - engine.graph().states.back().t));
    for (std::size_t j = 0; j < landmarks_.size(); ++j) {
      const auto& all = landmarks_[j].observations;
      const int newest = k - landmarks_[j].first;
      if (newest < kEnters - 1 || newest >= static_cast<int>(all.size())) continue;
      for (int i = newest == kEnters - 1 ? 0 : newest; i <= newest; ++i) {
        engine.add_observation(static_cast<int>(j), all[at(i)]);
      }
    }
    engine.update();
  }
  return engine;
}

}  // namespace evbench::smoother::testing
