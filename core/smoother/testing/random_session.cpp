#include "core/smoother/testing/random_session.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "core/testing/catch2.hpp"

namespace evbench::smoother::testing {
namespace {

const PinholeCamera kCamera{200.0, 200.0, 120.0, 90.0};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

SE3 true_pose(double t) {
  SE3 T;
  T.q = Eigen::Quaterniond(Eigen::AngleAxisd(0.2 * std::sin(0.9 * t), Vector3(0.3, 1.0, 0.2).normalized()));
  T.p = Vector3(std::sin(1.3 * t), 0.4 * std::sin(0.7 * t), 0.3 * std::cos(t));
  return T;
}

void require_finite(const FactorGraph& graph) {
  bool finite = true;
  for (const auto& state : graph.states) {
    finite = finite && state.T.p.allFinite() && state.T.q.coeffs().allFinite() && state.velocity.allFinite();
  }
  for (const auto& landmark : graph.landmarks) finite = finite && landmark.position.allFinite();
  REQUIRE(finite);
}

/// Up to rounding, for any units of its rows.
void require_positive_definite(const Eigen::MatrixXd& covariance) {
  REQUIRE(covariance.allFinite());
  REQUIRE(covariance.diagonal().minCoeff() > 0.0);
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  constexpr double kRounding = 1e-6;
  REQUIRE(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(correlation, Eigen::EigenvaluesOnly).eigenvalues()(0) >
          -kRounding);
}

}  // namespace

SmootherOptions linear_options() {
  SmootherOptions linear;
  linear.relinearise = linear.relinearise_redone = linear.check_step = std::numeric_limits<double>::infinity();
  linear.solve_tolerance = 0.0;
  return linear;
}

RandomSession::RandomSession(std::uint64_t seed, const SessionOptions& options)
    : random_(seed),
      options_(options),
      engine_(kCamera, Vector6::Constant(0.2), chance(0.3) ? RobustLoss(RobustLoss::Kind::cauchy, 2.0) : RobustLoss(),
              options.engine, options.motion_prior) {
  if (options.full_twin) {
    SmootherOptions full = options.engine;
    full.lag = 0.0;
    twin_.emplace(graph(), full);
  }
  ControlState first;
  first.T = true_pose(0.0);
  state_guesses_.push_back(first);
  for (Smoother* engine : {&engine_, twin_ ? &*twin_ : nullptr}) {
    if (engine == nullptr) continue;
    engine->add_state(first);
    engine->add_pose_prior({0, first.T, Vector6::Constant(0.01)});
    engine->add_velocity_prior({0, Vector6::Zero(), Vector6::Constant(2.0)});
  }
  update();
}

int RandomSession::draw_length() {
  if (chance(0.02)) return 30 + static_cast<int>(random_.index(120));
  return 3 + static_cast<int>(random_.index(28));
}

void RandomSession::operate() {
  const double which = random_.uniform();
  if (which < 0.33 || truth_.empty()) return add_state();
  if (which < 0.46) return late_observation();
  if (which < 0.50) return remove_landmark(any_landmark());
  if (which < 0.52) return remove_observations();
  if (which < 0.53) return scale_sigmas();
  if (which < 0.65) {
    if (const auto seen = draw_observation())
      give(seen->landmark, seen->observation);  // also if it was eliminated or removed
  } else if (which < 0.73) {
    refused();
  } else if (which < 0.75) {
    degenerate_landmark();
  } else if (which < 0.78) {
    remove_newest_state();
  } else if (which < 0.81) {
    if (options_.anchor) anchor_scale();
  } else if (which < 0.82) {
    for (const int j : std::vector(graph().anchor.landmarks)) remove_landmark(j);
  } else if (which < 0.85) {
    if (options_.covariances) check_covariances();
  } else if (which < 0.99) {
    update();
  } else {
    place();
  }
}

void RandomSession::update() {
  undetermined_ |= !engine_.update().reason.empty();
  require_finite(graph());
  if (!twin_) return;
  undetermined_ |= !twin_->update().reason.empty();
  require_finite(twin_->graph());
}

FactorGraph RandomSession::linear_problem() const {
  FactorGraph problem = twin_ ? twin_->graph() : graph();
  problem.states = state_guesses_;
  for (std::size_t j = 0; j < landmark_guesses_.size(); ++j) problem.landmarks[j].position = landmark_guesses_[j];
  return problem;
}

void RandomSession::check_covariances() {
  const int states = static_cast<int>(graph().states.size());
  const int k = static_cast<int>(random_.index(graph().states.size()));
  const auto joint = engine_.neighbours(k);
  if (joint) require_positive_definite(*joint);
  if (k + 1 >= states || k < engine_.first_state()) CHECK_FALSE(joint);
  if (const auto covariance = engine_.covariance(random_.uniform(0.0, newest())))
    require_positive_definite(*covariance);
  CHECK_FALSE(engine_.covariance(newest() + 0.1));
  if (truth_.empty()) return;
  if (const auto covariance = engine_.landmark_covariance(any_landmark())) require_positive_definite(*covariance);
}

void RandomSession::add_state() {
  const double gap = random_.uniform();
  const double dt = gap < 0.02 ? 5.0 : random_.uniform(0.02, 0.15);
  const ControlState last = twin_ ? twin_->graph().states.back() : graph().states.back();
  ControlState next = last;
  next.t += dt;
  next.T = dt > 1.0 ? true_pose(next.t) : last.T * se3::exp(dt * last.velocity);
  if (chance(0.5)) update();  // then observations may be added one by one
  state_guesses_.push_back(next);
  engine_.add_state(next);
  if (twin_) twin_->add_state(next);
  const double share = chance(0.1) ? 0.0 : 0.8;  // sometimes nothing is observed
  const int count = static_cast<int>(truth_.size());
  for (int j = std::max(0, count - 7); j < count; ++j) {
    if (chance(share)) observe(j, last.t, next.t);
  }
  while (chance(0.5)) {
    add_landmark();
    const bool from_one_place = chance(0.1);
    observe(static_cast<int>(truth_.size()) - 1, from_one_place ? next.t : last.t, next.t);
    if (chance(0.9)) observe(static_cast<int>(truth_.size()) - 1, from_one_place ? next.t : last.t, next.t);
  }
}

int RandomSession::insert_landmark(const Vector3& truth, const Vector3& guess, const LandmarkPrior& prior) {
  truth_.push_back(truth);
  landmark_guesses_.push_back(guess);
  if (twin_) twin_->add_landmark(guess, prior);
  return engine_.add_landmark(guess, prior);
}

void RandomSession::add_landmark() {
  const Vector3 q = random_.uniform3({-1.0, -0.8, 2.0}, {1.0, 0.8, 6.0});
  const SE3 T = true_pose(newest());
  const Vector3 guess = T * (random_.uniform(0.8, 1.25) * q);
  insert_landmark(T * q, guess, chance(0.9) ? LandmarkPrior{guess, 1.0} : LandmarkPrior{});
}

int RandomSession::add_close_landmark(double depth) {
  const Vector3 guess = state_guesses_.back().T * Vector3(0.0, 0.0, depth);
  const int j = insert_landmark(true_pose(newest()) * Vector3(0.1, -0.2, 3.0), guess, {guess, 1.0});
  CHECK(give(j, *measure(j, newest())));
  return j;
}

/// None if it is not in front of the camera.
std::optional<Observation> RandomSession::measure(int landmark, double t) {
  const Vector3 q = true_pose(t).inverse() * truth_[index(landmark)];
  if (q.z() < 0.1) return std::nullopt;
  const Vector2 noise = random_.uniform2({-1.0, -1.0}, {1.0, 1.0});
  const Vector3 whitening = random_.uniform3({0.5, -0.5, 0.5}, {1.5, 0.5, 1.5});
  return Observation{t, kCamera.project(q) + noise, {whitening.x(), whitening.y(), whitening.z()}};
}

std::optional<RandomSession::Seen> RandomSession::draw_observation() {
  const std::size_t states = graph().states.size();
  if (truth_.empty() || states < 2) return std::nullopt;
  const int j = any_landmark();
  const auto observation = measure(j, time_in(graph().states[states - 2].t, newest()));
  if (!observation) return std::nullopt;
  return Seen{j, *observation};
}

void RandomSession::observe(int landmark, double from, double to) {
  const double t = time_in(from, to);
  const auto observation = measure(landmark, t);
  if (observation) give(landmark, *observation);
  const auto second = chance(0.05) ? measure(landmark, t) : std::nullopt;  // two at one time
  if (second) give(landmark, *second);
}

/// Adds an observation, one by one or for the next update. Returns whether it was accepted.
bool RandomSession::give(int landmark, const Observation& observation) {
  const int before = graph().observation_count();
  bool accepted;
  if (chance(0.3)) {
    const bool followed = engine_.add_observation_and_update(landmark, observation);
    require_finite(graph());
    accepted = graph().observation_count() > before;
    if (followed) CHECK(accepted);
  } else {
    accepted = engine_.add_observation(landmark, observation);
  }
  CHECK(graph().observation_count() == before + (accepted ? 1 : 0));
  if (accepted) CHECK(graph().landmarks[index(landmark)].alive);
  if (accepted && twin_) CHECK(twin_->add_observation(landmark, observation));
  return accepted;
}

/// Of any landmark, also of ended, eliminated and removed ones.
void RandomSession::late_observation() {
  const double to = random_.uniform(0.0, newest());
  observe(any_landmark(), chance(0.3) ? 0.0 : 0.5 * to, to);
}

void RandomSession::remove_landmark(int landmark) {
  if (twin_) {  // marginalised observations cannot be removed
    const auto& seen = twin_->graph().landmarks[index(landmark)].intervals;
    if (!seen.empty() && seen.front() <= engine_.first_state()) return;
    twin_->remove_landmark(landmark);
  }
  engine_.remove_landmark(landmark);
}

void RandomSession::remove_observations() {
  const double marginalised = graph().states[index(engine_.first_state())].t;
  const double from = chance(0.2) ? 0.0 : random_.uniform(0.0, newest());
  if (twin_ && from <= marginalised) return;  // marginalised observations cannot be removed
  const int j = any_landmark();
  engine_.remove_observations(j, from);
  if (twin_) twin_->remove_observations(j, from);
}

void RandomSession::scale_sigmas() {
  const int j = any_landmark();
  const double scale = random_.uniform(0.5, 3.0);
  if (twin_) {
    const auto& seen = twin_->graph().landmarks[index(j)].intervals;
    if (!seen.empty() && seen.front() <= engine_.first_state()) return;
    twin_->scale_sigmas(j, scale);
  }
  engine_.scale_sigmas(j, scale);
}

/// Moves the estimates of a state and of a landmark, and with them their linearisation points, unless they are
/// marginalised.
void RandomSession::place() {
  const auto away = [&](const Vector3& from) -> Vector3 {
    return from + 0.1 * random_.uniform3({-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0});
  };
  const auto i = random_.index(graph().states.size());
  ControlState state = graph().states[i];
  state.T.p = away(state.T.p);
  state.velocity.tail<3>() = away(state.velocity.tail<3>());
  if (engine_.set_state(static_cast<int>(i), state)) {
    state_guesses_[i] = state;
    if (twin_) CHECK(twin_->set_state(static_cast<int>(i), state));
  } else {
    CHECK(static_cast<int>(i) <= engine_.first_state());
  }
  if (twin_) return require_finite(graph());  // the engines differ in which returned landmarks they may move
  const int j = any_landmark();
  const Vector3 position = away(graph().landmarks[index(j)].position);
  if (engine_.set_landmark(j, position)) landmark_guesses_[index(j)] = position;
  require_finite(graph());
}

void RandomSession::remove_newest_state() {
  if (static_cast<int>(graph().states.size()) <= engine_.first_state() + 3) return;
  state_guesses_.pop_back();
  engine_.remove_newest_state();
  if (twin_) twin_->remove_newest_state();
}

void RandomSession::refused() {
  const int j = any_landmark();
  CHECK_FALSE(engine_.add_observation(j, {newest() + 1.0, {120.0, 90.0}, 1.0}));
  CHECK_FALSE(engine_.add_observation(j, {-1.0, {120.0, 90.0}, 1.0}));
  CHECK_FALSE(engine_.add_observation(j, {newest(), {kNaN, 90.0}, 1.0}));
  CHECK_FALSE(engine_.add_observation(j, {kNaN, {120.0, 90.0}, 1.0}));
  CHECK_FALSE(engine_.add_observation_and_update(j, {newest() + 1.0, {120.0, 90.0}, 1.0}));
  CHECK_FALSE(engine_.add_observation_and_update(j, {newest(), {120.0, kNaN}, 1.0}));
}

/// A landmark behind the camera or nearly at infinity, with or without a prior, observed anywhere in the image.
void RandomSession::degenerate_landmark() {
  if (graph().states.size() < 2) return;
  const SE3 T = true_pose(newest());
  const Vector3 behind = T * Vector3(0.1, 0.2, -3.0);
  const Vector3 far = T * (std::pow(10.0, random_.uniform(3.0, 12.0)) * Vector3(0.1, -0.2, 1.0));
  const Vector3 place = chance(0.5) ? far : behind;
  const int j = insert_landmark(place, place, chance(0.5) ? LandmarkPrior{place, 1.0} : LandmarkPrior{});
  const Vector2 pixel = random_.uniform2({0.0, 0.0}, {240.0, 180.0});
  give(j, {time_in(graph().states[graph().states.size() - 2].t, newest()), pixel, 1.0});
}

/// Anchors the scale of some landmarks, observed or not.
void RandomSession::anchor_scale() {
  std::vector<int> anchors;
  for (int j = static_cast<int>(truth_.size()) - 1; j >= 0 && anchors.size() < 5; --j) {
    if (graph().landmarks[index(j)].alive && chance(0.6)) anchors.push_back(j);
  }
  engine_.anchor_scale(graph().states.front().T.p - Vector3(0.0, 0.0, 0.5), anchors);
}

}  // namespace evbench::smoother::testing
