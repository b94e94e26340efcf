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

/// In each interval the local variable (ξ, ξ', ξ'') of the prior is a Gauss-Markov chain from (0, ϖ_{k−1}, ϖ'_{k−1}).
/// Back in the body frame ϖ' is J_r(ξ) (ξ'' − ∂(J_r(ξ)⁻¹ϖ)/∂ξ ξ'), with what GpInterval calls c_1 for ξ''.
void DrawnProblem::draw_trajectory() {
  const MotionPrior& prior = options_.motion_prior;
  const int orders = prior.orders();
  Eigen::MatrixXd phi(orders, orders), root(orders, orders);
  if (prior.has_acceleration()) {
    phi = singer::transition(kStep, prior.rate);
    root = singer::process_covariance(kStep, prior.rate).llt().matrixL();
  } else {
    const Matrix12 Q = wnoa::process_covariance(kStep, Vector6::Ones());
    phi << 1.0, kStep, 0.0, 1.0;
    root = Matrix2((Matrix2() << Q(0, 0), Q(0, 6), Q(6, 0), Q(6, 6)).finished()).llt().matrixL();
  }
  ControlState start;
  start.T = pose_prior_.T * se3::exp(normal6(pose_prior_.sigma[0]));
  start.velocity = velocity_prior_.velocity + normal6(velocity_prior_.sigma[0]);
  if (prior.has_acceleration()) start.acceleration = normal6(std::sqrt(0.5 * prior.rate * options_.qc));
  truth_.push_back(start);
  for (int k = 1; k < kStates; ++k) {
    Eigen::Matrix<double, 6, Eigen::Dynamic> local = Eigen::MatrixXd::Zero(6, orders), noise = local;
    local.col(1) = start.velocity;
    if (prior.has_acceleration()) local.col(2) = start.acceleration;
    for (int step = 0; step < kSteps; ++step) {
      for (int order = 0; order < orders; ++order) noise.col(order) = normal6(std::sqrt(options_.qc));
      local = (local * phi.transpose() + noise * root.transpose()).eval();
      const Vector6 xi = local.col(0);
      ControlState state{kStep * static_cast<double>(truth_.size()), start.T * se3::exp(xi),
                         se3::right_jacobian(xi) * local.col(1)};
      if (prior.has_acceleration()) {
        state.acceleration =
            se3::right_jacobian(xi) * (local.col(2) - se3::d_right_jacobian_inverse(xi, state.velocity) * local.col(1));
      }
      truth_.push_back(state);
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
    const SE3 T = GpInterval(truth((k - 1) * kSteps), truth(k * kSteps), options_.motion_prior).pose(t);
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
  Smoother engine(camera(), qc_, RobustLoss(), engine_options, options_.motion_prior);
  for (const Landmark& landmark : landmarks_) engine.add_landmark(landmark.guess, landmark.prior);
  engine.add_state({0.0, pose_prior_.T, velocity_prior_.velocity});
  engine.add_pose_prior(pose_prior_);
  engine.add_velocity_prior(velocity_prior_);
  if (!anchors_.empty()) engine.anchor_scale(pose_prior_.T.p, anchors_);
  engine.update();
  for (int k = 1; k < kStates; ++k) {
    engine.add_state_at(truth(k * kSteps).t);
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
