#include <cmath>
#include <vector>

#include "core/geometry/solve_symmetric.hpp"
#include "core/smoother/batch_solver.hpp"
#include "core/smoother/problem_graph.hpp"
#include "core/smoother/smoother.hpp"
#include "core/smoother/testing/drawn_problem.hpp"
#include "core/support/index.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

namespace evbench::smoother {

namespace {

const std::vector<MotionPrior> kPriors = {{}, {20.0}};  // WNOA, Singer's

}  // namespace

TEST_CASE("Optimising with the engine ends where the batch solver ends") {
  const auto path = evbench::testing::problem_file("small.txt.gz");
  if (!path) return;
  const MotionPrior prior = GENERATE(from_range(kPriors));
  FactorGraph oracle = to_graph(read_problem(*path), prior);
  Smoother engine(oracle, {});
  const auto summary = engine.optimise(10, 1e-12);
  const auto expected = solve_batch(oracle, {20, 1e-12});
  CHECK(summary.converged);
  CHECK(summary.final_cost == Approx(expected.final_cost).epsilon(1e-9));
  for (std::size_t i = 0; i < oracle.states.size(); ++i) {
    const Vector6 apart = se3::log(oracle.states[i].T.inverse() * engine.graph().states[i].T);
    CHECK(apart.norm() < 1e-6);
  }
}

TEST_CASE("Covariances of the engine equal those of the batch solver") {
  const auto path = evbench::testing::problem_file("small.txt.gz");
  if (!path) return;
  const MotionPrior prior = GENERATE(from_range(kPriors));
  Smoother engine(to_graph(read_problem(*path), prior), {});
  engine.optimise(10, 1e-12);
  engine.optimise(2, 1e-12);  // once more from the optimum: covariances are those at the linearisation points
  const BatchCovariance oracle(engine.graph());
  const int newest = static_cast<int>(engine.graph().states.size()) - 1;
  for (const int k : {0, 1, 50, newest - 2, newest - 1}) {
    const auto joint = engine.neighbours(k);
    const auto expected = oracle.neighbours(k);
    REQUIRE(joint);
    REQUIRE(expected);
    CHECK((*joint - *expected).norm() < 1e-6 * expected->norm());
  }
  const int first = newest / 2;
  const std::vector<PairMatrix> chain = engine.chain_covariances(first);
  REQUIRE(std::ssize(chain) == newest - first + 1);
  for (const int k : {first, first + 7, newest - 1, newest}) {
    const PairMatrix expected = *engine.neighbours(k - 1);
    CHECK((chain[index(k - first)] - expected).norm() < 1e-9 * expected.norm());
  }
  for (const auto& [i, j] : {std::pair(0, 1), {3, 23}, {0, newest}, {newest - 20, newest}, {newest - 1, newest}}) {
    const auto joint = engine.poses(i, j);
    const auto expected = oracle.poses(i, j);
    REQUIRE(joint);
    REQUIRE(expected);
    CHECK((*joint - *expected).norm() < 1e-6 * expected->norm());
    CHECK((joint->topRightCorner<6, 6>() - expected->topRightCorner<6, 6>()).norm() < 1e-6 * expected->norm());
  }
  CHECK_FALSE(engine.poses(3, 3));
  CHECK_FALSE(engine.poses(3, newest + 1));
  for (const double t : {0.01, 2.513, engine.graph().states.back().t}) {
    CHECK((*engine.covariance(t) - *oracle.at(t)).norm() < 1e-6 * oracle.at(t)->norm());
  }
  const int landmarks = static_cast<int>(engine.graph().landmarks.size());
  for (const int j : {0, landmarks / 2, landmarks - 1}) {
    if (!engine.graph().landmarks[index(j)].alive) continue;
    CHECK((*engine.landmark_covariance(j) - *oracle.landmark(j)).norm() < 1e-6 * oracle.landmark(j)->norm());
  }
}

TEST_CASE("A landmark's mean reprojection error is kept to within a third of a pixel through updates and removals") {
  const testing::DrawnProblem problem({.pixel_sigma = 1.0}, 1);
  Smoother engine = problem.solve_incrementally();
  engine.remove_landmark(3);
  engine.remove_newest_state();
  engine.update();
  CHECK(engine.reprojection_mean(3) == 0.0);
  for (int j = 0; j < static_cast<int>(engine.graph().landmarks.size()); ++j) {
    CAPTURE(j);
    CHECK(std::abs(engine.reprojection_mean(j) - reprojection_mean(engine.graph(), j)) < 1.0 / 3.0);
  }
  engine.optimise(30, 1e-12);
  engine.optimise(1, 1e-12);  // linearised at the optimum
  for (int j = 0; j < static_cast<int>(engine.graph().landmarks.size()); ++j) {
    CHECK(engine.reprojection_mean(j) == Approx(reprojection_mean(engine.graph(), j)).margin(1e-3));
  }
}

TEST_CASE("After each observation the newest states equal those of an update with the same observations") {
  const auto path = evbench::testing::problem_file("small.txt.gz");
  if (!path) return;
  const MotionPrior prior = GENERATE(from_range(kPriors));
  const FactorGraph all = to_graph(read_problem(*path), prior);
  constexpr int kStates = 40;
  FactorGraph start = all;
  while (start.states.size() > kStates) start.remove_newest_state();
  SmootherOptions linear;
  linear.relinearise = linear.relinearise_redone = linear.check_step = 1e9;
  linear.solve_tolerance = 0.0;
  Smoother one_by_one(start, linear);
  one_by_one.optimise(10, 1e-10);
  ControlState next = one_by_one.graph().states.back();
  const double dt = all.states[kStates].t - next.t;
  next.t += dt;
  next.T = next.T * se3::exp(dt * next.velocity);
  one_by_one.add_state(next);
  Smoother at_once = one_by_one, queried = one_by_one;
  REQUIRE(queried.open_newest_interval());
  int live = 0;
  const IntervalObservations& interval = all.intervals[kStates];
  for (const auto& group : interval.groups()) {
    for (int i = group.begin; i < group.end; ++i) {
      const Observation& z = interval.all()[index(i)];
      if (start.landmarks[index(group.landmark)].intervals.empty()) continue;
      if (live % 3 == 0) CHECK(queried.newest_covariance());  // queries change nothing
      const bool followed = one_by_one.add_observation_and_update(group.landmark, z);
      CHECK(queried.add_observation_and_update(group.landmark, z) == followed);
      if (!followed) continue;
      for (const std::size_t k : {kStates - 1, kStates}) {
        CHECK(queried.graph().states[k].T.p == one_by_one.graph().states[k].T.p);
      }
      at_once.add_observation(group.landmark, z);
      ++live;
      if (live % 20 != 1) continue;
      Smoother updated = at_once;
      updated.update();
      for (const std::size_t k : {kStates - 1, kStates}) {
        const ControlState& a = one_by_one.graph().states[k];
        const ControlState& b = updated.graph().states[k];
        CHECK(se3::log(a.T.inverse() * b.T).norm() < 1e-8);
        CHECK((a.velocity - b.velocity).norm() < 1e-7);
      }
    }
  }
  CHECK(live > 50);
}

TEST_CASE(
    "With a lag the newest state agrees with full history within its uncertainty, and old intervals are dropped") {
  const auto path = evbench::testing::problem_file("small.txt.gz");
  if (!path) return;
  const FactorGraph all = to_graph(read_problem(*path));
  SmootherOptions lagged;
  lagged.lag = 2.0;
  Smoother full(all.camera, all.qc, all.loss), lag(all.camera, all.qc, all.loss, lagged);
  for (Smoother* engine : {&full, &lag}) {
    for (const auto& landmark : all.landmarks) engine->add_landmark(landmark.position, landmark.prior);
  }
  for (std::size_t k = 0; k < all.states.size(); ++k) {
    for (Smoother* engine : {&full, &lag}) {
      ControlState state = all.states[k];
      if (k > 0) {
        const ControlState& newest = engine->graph().states.back();
        state.T = newest.T * se3::exp((state.t - newest.t) * newest.velocity);
        state.velocity = newest.velocity;
      }
      engine->add_state(state);
      if (k == 0) {
        for (const auto& prior : all.pose_priors) engine->add_pose_prior(prior);
        for (const auto& prior : all.velocity_priors) engine->add_velocity_prior(prior);
      }
      const IntervalObservations& interval = all.intervals[k];
      for (const auto& group : interval.groups()) {
        for (int i = group.begin; i < group.end; ++i) {
          CHECK(engine->add_observation(group.landmark, interval.all()[index(i)]));
        }
      }
      engine->update();
    }
  }
  CHECK(full.first_state() == 0);
  const int first = lag.first_state();
  CHECK(lag.graph().states.back().t - lag.graph().states[index(first)].t < 3.6);
  CHECK(first > 20);
  for (int k = 1; k <= first; ++k) CHECK(lag.graph().intervals[index(k)].all().empty());
  CHECK_FALSE(lag.add_observation(all.intervals[2].groups()[0].landmark, {all.states[2].t, {100.0, 100.0}, 1.0}));

  const PairMatrix joint = *full.neighbours(static_cast<int>(all.states.size()) - 2);
  const Vector6 apart = se3::log(full.graph().states.back().T.inverse() * lag.graph().states.back().T);
  const Matrix6 pose = joint.block<6, 6>(12, 12);
  CHECK(apart.dot(solve_symmetric(pose, apart)) < 6.0);  // the mean if it were as far off as the truth
  CHECK(lag.neighbours(first));
  CHECK_FALSE(lag.neighbours(first - 1));
}

TEST_CASE("A state at a time continues the newest one, and the first one is at the origin") {
  Smoother smoother({200.0, 200.0, 120.0, 90.0}, Vector6::Constant(0.2), RobustLoss());
  smoother.add_state_at(1.0);
  const ControlState& first = smoother.graph().states.front();
  CHECK(first.t == 1.0);
  CHECK(first.T.p.norm() == 0.0);
  CHECK(first.velocity.norm() == 0.0);
  ControlState moving;
  moving.t = 2.0;
  moving.velocity << 0.0, 0.0, 0.0, 0.5, 0.0, 0.0;
  smoother.add_state(moving);
  smoother.add_state_at(2.2);
  CHECK(smoother.graph().states.back().T.p.x() == Approx(0.1));
}

TEST_CASE("An undetermined variable is named and regularised, and the rest is solved") {
  Smoother engine({200.0, 200.0, 120.0, 90.0}, Vector6::Constant(0.2), RobustLoss());
  engine.add_state({});
  engine.add_pose_prior({0, SE3(), Vector6::Constant(0.01)});
  const UpdateSummary velocity = engine.update();
  CHECK(velocity.reason == "state 0 is not determined by its observations and priors");
  engine.add_velocity_prior({0, Vector6::Zero(), Vector6::Constant(0.1)});
  ControlState next;
  next.t = 0.1;
  engine.add_state(next);
  const Vector3 guess(0.2, 0.1, 3.0);
  const int seen_once = engine.add_landmark(guess);
  REQUIRE(engine.add_observation(seen_once, {0.05, {120.0, 90.0}, 1.0}));
  const UpdateSummary update = engine.update();
  CHECK(update.reason == "landmark 0 is not determined by its observations and priors");
  CHECK_FALSE(update.rejected);
  const Vector3 solved = engine.graph().landmarks[0].position;
  CHECK(solved.z() == Approx(3.0).margin(0.1));  // its depth stays as guessed
  CHECK(solved.head<2>().norm() < 0.05);         // its direction follows the observation
}

}  // namespace evbench::smoother
