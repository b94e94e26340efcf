#include "core/smoother/engine/returns.hpp"

#include <cmath>

#include "core/smoother/cost.hpp"
#include "core/smoother/smoother.hpp"
#include "core/smoother/testing/random_session.hpp"
#include "core/support/index.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::smoother {
namespace {

const PinholeCamera kCamera{200.0, 200.0, 120.0, 90.0};

/// A camera that moves to and fro past a wall of landmarks, so that all of them are re-acquired repeatedly.
class Patrol {
 public:
  /// `unknown`: a landmark without prior; −1: none.
  explicit Patrol(const SmootherOptions& options, int unknown = -1) : engine(graph(), options) {
    for (int j = 0; j < kLandmarks; ++j) {
      const Vector3 guess = 1.03 * landmark(j);
      engine.add_landmark(guess, j == unknown ? LandmarkPrior{} : LandmarkPrior{guess, 1.0});
    }
    engine.add_state(guess(0));
    engine.add_pose_prior({0, guess(0).T, Vector6::Constant(0.01)});
    engine.add_velocity_prior({0, guess(0).velocity, Vector6::Constant(0.5)});
  }

  static constexpr double kStep = 0.05;  ///< [s] between states
  static constexpr int kLandmarks = 40;
  static Vector3 landmark(int j) { return {0.15 * j, 0.3 * (j % 3) - 0.3, 1.5 + 0.2 * (j % 5)}; }
  static double place(double t) { return 2.5 - 2.0 * std::cos(1.1 * t); }
  static ControlState guess(int k) {
    ControlState state;
    state.t = kStep * k;
    state.T.p = {place(state.t) + 0.01 * (k % 3), 0.01 * (k % 4), 0.0};
    state.velocity(3) = 2.2 * std::sin(1.1 * state.t);
    return state;
  }
  bool observe(int j, double t) {
    const Vector3 q = landmark(j) - Vector3(place(t), 0.0, 0.0);
    const Vector2 noise(0.5 * std::sin(97.0 * t + j), 0.5 * std::cos(61.0 * t + 2.0 * j));
    return engine.add_observation(j, {t, kCamera.project(q) + noise, 1.0});
  }
  /// Adds a state and observes each landmark in view twice. A follower gets the observations that were accepted here.
  void step(Patrol* follower = nullptr) {
    const int k = static_cast<int>(engine.graph().states.size());
    engine.add_state(guess(k));
    if (follower != nullptr) follower->engine.add_state(guess(k));
    for (int j = 0; j < kLandmarks; ++j) {
      if (std::abs(landmark(j).x() - place(kStep * k)) > 0.7) continue;
      for (const double back : {0.6, 0.1}) {
        if (observe(j, kStep * (k - back)) && follower != nullptr) CHECK(follower->observe(j, kStep * (k - back)));
      }
    }
  }
  void advance(int states) {
    for (int i = 0; i < states; ++i) {
      step();
      const UpdateSummary update = engine.update();
      CHECK(update.reason.empty());
      stages += update.stages;
    }
  }

  Smoother engine;
  int stages = 0;  ///< redone so far

 private:
  static FactorGraph graph() {
    FactorGraph empty;
    empty.camera = kCamera;
    empty.qc = Vector6::Constant(0.2);
    return empty;
  }
};

SmootherOptions options(int redone_for_return) {
  SmootherOptions result = testing::linear_options();
  result.redone_for_return = redone_for_return;
  return result;
}
const int kAlways = 1'000'000;

void check_same(Smoother& a, Smoother& b) {
  const int newest = static_cast<int>(a.graph().states.size()) - 1;
  for (int k = a.first_state(); k <= newest; ++k) {
    CAPTURE(k);
    CHECK((a.graph().states[index(k)].T.p - b.graph().states[index(k)].T.p).norm() < 1e-8);
    CHECK((a.graph().states[index(k)].velocity - b.graph().states[index(k)].velocity).norm() < 1e-7);
  }
  for (int j = 0; j < Patrol::kLandmarks; ++j) {
    CAPTURE(j);
    if (a.is_marginalised(j)) continue;
    CHECK((a.graph().landmarks[index(j)].position - b.graph().landmarks[index(j)].position).norm() < 1e-8);
  }
}

template <class Matrix>
void check_close(const Matrix& a, const Matrix& b) {
  CHECK((a - b).norm() < 1e-7 * b.norm());
}

void check_same_covariances(Smoother& a, Smoother& b) {
  const int newest = static_cast<int>(a.graph().states.size()) - 1;
  const std::vector<PairMatrix> chain = a.chain_covariances(1);
  REQUIRE(std::ssize(chain) == newest);
  for (int k = 0; k < newest; k += 7) {
    CAPTURE(k);
    check_close(*a.neighbours(k), *b.neighbours(k));
    check_close(chain[index(k)], *b.neighbours(k));
  }
  for (const int i : {0, newest / 3, newest - 5}) check_close(*a.poses(i, newest), *b.poses(i, newest));
  int known = 0;
  for (int j = 0; j < Patrol::kLandmarks; j += 3) {
    const auto one = a.landmark_covariance(j), other = b.landmark_covariance(j);
    REQUIRE(one.has_value() == other.has_value());  // none for a landmark that was never observed
    if (!one) continue;
    check_close(*one, *other);
    ++known;
  }
  CHECK(known > Patrol::kLandmarks / 6);
}

}  // namespace

TEST_CASE("Landmarks that return repeatedly end as if all stages had been redone each time") {
  Patrol back(options(0)), redone(options(kAlways));
  for (Patrol* patrol : {&back, &redone}) patrol->advance(260);
  CHECK(back.engine.graph().observation_count() > 3000);
  CHECK(back.stages < redone.stages / 5);
  check_same(back.engine, redone.engine);
  check_same_covariances(back.engine, redone.engine);
}

TEST_CASE("Stages before and after a return can be redone, and states removed") {
  Patrol back(options(0)), redone(options(kAlways));
  for (Patrol* patrol : {&back, &redone}) {
    patrol->advance(130);
    patrol->observe(3, Patrol::kStep * 100.5);  // out of view: any pixel will do
    patrol->advance(1);
    patrol->observe(30, Patrol::kStep * 2.5);
    patrol->advance(9);
    for (int i = 0; i < 12; ++i) patrol->engine.remove_newest_state();
    patrol->engine.update();
    patrol->advance(20);
    patrol->engine.remove_landmark(7);
    patrol->observe(20, Patrol::kStep * 130.5);
    patrol->observe(20, Patrol::kStep * 60.5);
    patrol->advance(30);
  }
  check_same(back.engine, redone.engine);
  check_same_covariances(back.engine, redone.engine);
}

TEST_CASE("Returned landmarks change old states gradually, and update_everything() updates all of them", "[slow]") {
  Patrol waiting({}), settled({});
  int waited = 0;
  for (int k = 0; k < 260; ++k) {
    waiting.step();
    settled.step();
    waited += waiting.engine.update().solved_back < settled.engine.update_everything().solved_back ? 1 : 0;
  }
  CHECK(waited > 50);
  const auto cost = [](const Patrol& patrol) { return evaluate(patrol.engine.graph()).total(); };
  CHECK(cost(waiting) < 1.1 * cost(settled));
  CHECK(waiting.engine.update_everything().solved_back == 260);
  settled.engine.update_everything();
  CHECK(cost(waiting) < 1.03 * cost(settled));
}

TEST_CASE("A prior that is dropped leaves no trace") {
  constexpr int kUnknown = 7;
  Patrol dropped(options(0)), without(options(0), kUnknown);
  dropped.advance(150);
  dropped.engine.remove_prior(kUnknown);
  CHECK(dropped.engine.update().first_stage < 30);
  dropped.advance(30);
  without.advance(180);
  check_same(dropped.engine, without.engine);
}

TEST_CASE("With a lag, landmarks that return within it end as in full history") {
  SmootherOptions lagged = options(0);
  lagged.lag = 3.5;
  Patrol lag(lagged), full(options(0));
  for (int k = 0; k < 200; ++k) {
    lag.step(&full);
    lag.engine.update();
    full.engine.update();
  }
  CHECK(lag.engine.first_state() > 50);
  CHECK(full.engine.graph().observation_count() > 2000);
  check_same(lag.engine, full.engine);
}

TEST_CASE("In a strongly non-linear problem returns cost some accuracy, but not much", "[slow]") {
  SmootherOptions always;
  always.redone_for_return = kAlways;
  Patrol back({}), redone(always);
  for (Patrol* patrol : {&back, &redone}) patrol->advance(260);
  const double cost = evaluate(back.engine.graph()).total(), expected = evaluate(redone.engine.graph()).total();
  CHECK(cost < 1.4 * expected);
}

}  // namespace evbench::smoother
