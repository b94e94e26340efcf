#include "backends/gp_map/pose_jump.hpp"

#include <functional>
#include <utility>
#include <vector>

#include "core/simulation/random.hpp"
#include "core/support/median.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {
namespace {

constexpr int kStates = 80, kTurn = 40;  // an aggressive turn in the interval that ends in state kTurn
constexpr int kGlimpse = kTurn + 15;
constexpr double kStep = 0.01, kSigma = 0.3;
constexpr int kOld = 12, kNew = 30;
const Vector6 kUnnoticed = (Vector6() << 0.0, 0.2, 0.0, -0.3, 0.0, 0.0).finished();  // missed there

/// A camera that moves past landmarks that are seen until the turn and again for the last 0.05 s, and others that come
/// into view after it. `spanning` landmarks are seen all the time, and show the turn. The tracks of `drifted` landmarks
/// continue for a moment as if there were no turn. If `glimpsed`, the old landmarks were also seen for a moment some
/// time after the turn.
struct Scene {
  FactorGraph truth;
  std::vector<Reappearance> seen;

  Scene(int spanning, int drifted, const std::function<Vector2(const Vector2&, Random&)>& seen_at,
        bool glimpsed = false) {
    Random random(3);
    truth.camera = {200.0, 200.0, 120.0, 90.0};
    truth.qc = Vector6::Constant(1e3);
    truth.loss = RobustLoss(RobustLoss::Kind::cauchy, 2.0);
    ControlState state;
    state.velocity << 0.0, 0.1, 0.0, 0.3, 0.0, 0.0;
    for (int k = 0; k < kStates; ++k) {
      state.t = kStep * k;
      truth.add_state(state);
      state.T = state.T * se3::exp(kStep * state.velocity);
    }
    truth.pose_priors.push_back({0, truth.states.front().T, Vector6::Constant(1e-4)});
    const auto add = [&](int from, int until) {
      const SE3& T = truth.states[index((from + until) / 2)].T;
      const double depth = random.uniform(1.5, 4.0);
      const Vector3 ray = truth.camera.ray({random.uniform(30.0, 210.0), random.uniform(30.0, 150.0)});
      const int j = truth.add_landmark(T * Vector3(depth * ray));
      observe(j, from, until, random);
      return j;
    };
    for (int i = 0; i < kOld; ++i) {
      const int j = add(1, kTurn - 1), from = kStates - 5;
      truth.landmarks[index(j)].prior = {truth.landmarks[index(j)].position, 1e-3};
      if (glimpsed) observe(j, kGlimpse, kGlimpse + 2, random);
      for (int k = from; k < kStates; ++k) {
        const Vector2 pixel = seen_at(image(j, k), random);
        if (k == from) seen.push_back({j, kStep * k, pixel, glimpsed ? kGlimpse + 2 : kTurn - 1});
        truth.add_observation(j, {kStep * k, pixel, 1.0 / kSigma});
      }
    }
    for (int i = 0; i < kNew; ++i) add(kTurn, kStates - 1);
    for (int i = 0; i < spanning; ++i) add(1, kStates - 1);
    for (int i = 0; i < drifted; ++i) {
      const int j = add(1, kTurn - 1);
      for (int k = kTurn; k < kTurn + 5; ++k) {
        const Vector3 q = (unnoticed() * truth.states[index(k)].T).inverse() * truth.landmarks[index(j)].position;
        truth.add_observation(j, {kStep * k, truth.camera.project(q), 1.0 / kSigma});
      }
    }
  }

  /// An engine whose estimate misses the turn.
  Engine misled(double lag = 0.0) const {
    FactorGraph wrong = truth;
    const SE3 motion = unnoticed();
    for (int k = kTurn; k < kStates; ++k) wrong.states[index(k)].T = motion * wrong.states[index(k)].T;
    for (FactorGraph::Landmark& landmark : wrong.landmarks) {
      if (landmark.intervals.front() >= kTurn) landmark.position = motion * landmark.position;
    }
    EngineOptions options;
    options.lag = lag;
    return Engine(std::move(wrong), options);
  }

  double error(const Engine& engine, int state = kStates - 1) const {
    return se3::log(truth.states[index(state)].T.inverse() * engine.graph().states[index(state)].T).norm();
  }

 private:
  /// Displacement of the world frame in everything since the turn.
  SE3 unnoticed() const {
    const SE3& T = truth.states[kTurn].T;
    return T * se3::exp(kUnnoticed) * T.inverse();
  }

  Vector2 image(int j, int k) const {
    return truth.camera.project(truth.states[index(k)].T.inverse() * truth.landmarks[index(j)].position);
  }

  void observe(int j, int from, int until, Random& random) {
    for (int k = from; k <= until; ++k) {
      const Vector2 noise = random.normal2();
      truth.add_observation(j, {kStep * k, image(j, k) + kSigma * noise, 1.0 / kSigma});
    }
  }
};

Vector2 in_place(const Vector2& pixel, Random& random) { return pixel + kSigma * random.normal2(); }

Vector2 anywhere(const Vector2& pixel, Random& random) { return pixel + random.uniform2({-20.0, -20.0}, {20.0, 20.0}); }

Vector2 all_displaced(const Vector2& pixel, Random& random) { return in_place(pixel, random) + Vector2(12.0, 3.0); }

}  // namespace

TEST_CASE("An unnoticed turn of the camera is corrected by most of the old landmarks that are re-acquired") {
  const Scene scene(0, 10, in_place);
  Engine engine = scene.misled();
  for (int i = 0; i < 5; ++i) engine.update();
  REQUIRE(scene.error(engine) > 0.05);  // Gauss-Newton steps don't lead back
  const auto states = engine.graph().states.size();
  CHECK(correct_pose_jump(engine, scene.seen));
  CHECK(engine.graph().states.size() == states);
  for (const Reappearance& seen : scene.seen) CHECK(reappearance_error(engine.graph(), seen) < 2.0);
  Engine reference(scene.truth, {});
  for (int i = 0; i < 5; ++i) {
    engine.update();
    reference.update();
  }
  const SE3 T = engine.graph().states.back().T.inverse() * reference.graph().states.back().T;
  CHECK(se3::log(T).norm() < 0.05 * kUnnoticed.norm());  // nearly as if it had been noticed
  CHECK_FALSE(correct_pose_jump(engine, scene.seen));    // nothing is wrong any more
}

TEST_CASE("Landmarks that were re-acquired off their places before do not hide when the jump happened") {
  const Scene scene(0, 10, in_place, true);
  Engine engine = scene.misled();
  for (int i = 0; i < 5; ++i) engine.update();
  REQUIRE(scene.error(engine, kTurn + 5) > 0.05);
  CHECK(correct_pose_jump(engine, scene.seen));
  for (int i = 0; i < 5; ++i) engine.update();
  CHECK(scene.error(engine) < 0.02);
  CHECK(scene.error(engine, kTurn + 5) < 0.05);
}

TEST_CASE("Few landmarks, or landmarks with independent displacements, correct nothing") {
  for (const bool few : {true, false}) {
    const Scene scene(0, 10, few ? in_place : anywhere);
    Engine engine = scene.misled();
    engine.update();
    const ControlState before = engine.graph().states.back();
    CHECK_FALSE(correct_pose_jump(engine, std::span(scene.seen).first(few ? 4 : scene.seen.size())));
    CHECK(engine.graph().states.back().T.p == before.T.p);
  }
}

TEST_CASE("Landmarks with small independent displacements show no pose jump") {
  const Scene scene(40, 0, [](const Vector2& pixel, Random& random) -> Vector2 {
    return pixel + random.uniform2({-2.0, -2.0}, {2.0, 2.0});
  });
  Engine engine(scene.truth, {});
  for (int i = 0; i < 5; ++i) engine.update();
  std::vector<double> errors;
  for (const Reappearance& seen : scene.seen) errors.push_back(reappearance_error(engine.graph(), seen));
  REQUIRE(median(std::move(errors)) > 1.0);
  const ControlState before = engine.graph().states.back();
  CHECK_FALSE(correct_pose_jump(engine, scene.seen));
  CHECK(engine.graph().states.back().T.p == before.T.p);
}

TEST_CASE("Landmarks that most others contradict leave the estimate unchanged") {
  const Scene scene(40, 0, all_displaced);
  Engine engine(scene.truth, {});
  for (int i = 0; i < 5; ++i) engine.update();
  REQUIRE(scene.error(engine) < 0.005);
  CHECK_FALSE(correct_pose_jump(engine, scene.seen));
  CHECK(scene.error(engine) < 0.005);
  for (int i = 0; i < 5; ++i) engine.update();
  CHECK(scene.error(engine) < 0.005);
}

TEST_CASE("With a lag, too, a pose jump is corrected or the estimate is left unchanged") {
  for (const double lag : {0.05, 0.3, 0.5, 0.75, 10.0}) {
    CAPTURE(lag);
    const Scene scene(0, 10, in_place);
    Engine engine = scene.misled(lag);
    for (int i = 0; i < 5; ++i) engine.update();
    const double before = scene.error(engine);
    const bool found = correct_pose_jump(engine, scene.seen);
    for (int i = 0; i < 5; ++i) CHECK_FALSE(engine.update().unsolvable);
    CHECK(scene.error(engine) < (found ? 0.2 : 1.05) * before);
    if (lag == 10.0) CHECK(found);
  }
}

}  // namespace evbench::gp_map
