#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "backends/gp_map/batch_solver.hpp"
#include "backends/gp_map/engine/engine.hpp"

// Random sequences of everything that can be done to the engine, sensible or not, compared with the batch solver.
namespace evbench::gp_map {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr int kSequences = 100;
#else
constexpr int kSequences = 2500;
#endif
constexpr int kOperations = 40;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double a, double b) { return a + (b - a) * static_cast<double>(engine_()) / 4294967296.0; }
  int below(int n) { return static_cast<int>(uniform(0.0, n)); }
  bool chance(double p) { return uniform(0.0, 1.0) < p; }

 private:
  std::mt19937 engine_;
};

SE3 true_pose(double t) {
  SE3 T;
  T.q = Eigen::Quaterniond(Eigen::AngleAxisd(0.2 * std::sin(0.9 * t), Vector3(0.3, 1.0, 0.2).normalized()));
  T.p = Vector3(std::sin(1.3 * t), 0.4 * std::sin(0.7 * t), 0.3 * std::cos(t));
  return T;
}

/// A world, and an engine that is told about it in every way possible.
class Session {
 public:
  Session(unsigned seed, const EngineOptions& options)
      : random_(seed), engine(kCamera, Vector6::Constant(0.2), loss(), options) {
    ControlState first;
    first.T = true_pose(0.0);
    engine.add_state(first);
    engine.add_pose_prior({0, first.T, Vector6::Constant(0.01)});
    engine.add_velocity_prior({0, Vector6::Zero(), Vector6::Constant(2.0)});
    engine.update();
  }

  void operate() {
    const double which = random_.uniform(0.0, 1.0);
    if (which < 0.35) {
      add_state();
    } else if (which < 0.55) {
      late_observation();
    } else if (which < 0.62) {
      remove_landmark();
    } else if (which < 0.69) {
      remove_observation();
    } else if (which < 0.75) {
      if (!truth_.empty()) engine.end_landmark(random_.below(static_cast<int>(truth_.size())));
    } else if (which < 0.80) {
      degenerate();
    } else if (which < 0.83) {
      if (engine.graph().states.size() > 3) engine.remove_newest_state();
    } else {
      update();
    }
  }

  void update() {
    undetermined |= !engine.update().reason.empty();
    for (const auto& state : engine.graph().states) {
      REQUIRE(state.T.p.allFinite());
      REQUIRE(state.T.q.coeffs().allFinite());
      REQUIRE(state.velocity.allFinite());
    }
    for (const auto& landmark : engine.graph().landmarks) REQUIRE(landmark.position.allFinite());
  }

 private:
  inline static const PinholeCamera kCamera{200.0, 200.0, 120.0, 90.0};
  Random random_;
  std::vector<Vector3> truth_;

 public:
  Engine engine;
  bool undetermined = false;  ///< something was held in some update

 private:
  RobustLoss loss() { return random_.chance(0.3) ? RobustLoss("cauchy", 2.0) : RobustLoss(); }
  double newest() const { return engine.graph().states.back().t; }

  void add_state() {
    const ControlState last = engine.graph().states.back();
    const double dt = random_.chance(0.02) ? 5.0 : random_.uniform(0.02, 0.15);
    ControlState next = last;
    next.t += dt;
    next.T = dt > 1.0 ? true_pose(next.t) : last.T * se3::exp(dt * last.velocity);
    engine.add_state(next);
    const double share = random_.chance(0.1) ? 0.0 : 0.8;  // sometimes nothing is seen
    for (int j = 0; j < static_cast<int>(truth_.size()); ++j) {
      if (j + 8 > static_cast<int>(truth_.size()) && random_.chance(share)) observe(j, last.t, next.t);
    }
    while (random_.chance(0.5)) {
      add_landmark();
      observe(static_cast<int>(truth_.size()) - 1, last.t, next.t);
      if (random_.chance(0.9)) observe(static_cast<int>(truth_.size()) - 1, last.t, next.t);
    }
  }

  void add_landmark() {
    const Vector3 q(random_.uniform(-1.0, 1.0), random_.uniform(-0.8, 0.8), random_.uniform(2.0, 6.0));
    truth_.push_back(true_pose(newest()) * q);
    const Vector3 guess = true_pose(newest()) * (random_.uniform(0.8, 1.25) * q);
    LandmarkPrior prior;
    if (random_.chance(0.9)) prior = {guess, 1.0};
    engine.add_landmark(guess, prior);
  }

  void observe(int j, double from, double to) {
    const double t = random_.chance(0.1) ? to : random_.uniform(from, to);  // sometimes exactly at a state
    const Vector3 q = true_pose(t).inverse() * truth_[static_cast<std::size_t>(j)];
    if (q.z() < 0.1) return;
    const Vector2 noise(random_.uniform(-1.0, 1.0), random_.uniform(-1.0, 1.0));
    engine.add_observation(j, {t, kCamera.project(q) + noise, 1.0});
    if (random_.chance(0.05)) engine.add_observation(j, {t, kCamera.project(q) - noise, 1.0});  // two at one time
  }

  /// Of any landmark, ended and eliminated ones too.
  void late_observation() {
    if (truth_.empty()) return;
    const double to = random_.uniform(0.0, newest());
    observe(random_.below(static_cast<int>(truth_.size())), 0.5 * to, to);
  }

  void remove_landmark() {
    if (!truth_.empty()) engine.remove_landmark(random_.below(static_cast<int>(truth_.size())));
  }

  void remove_observation() {
    const auto& intervals = engine.graph().intervals;
    const auto& interval = intervals[static_cast<std::size_t>(random_.below(static_cast<int>(intervals.size())))];
    if (interval.groups().empty()) return;
    const auto& groups = interval.groups();
    const auto group = groups[static_cast<std::size_t>(random_.below(static_cast<int>(groups.size())))];
    const double t = interval.all()[static_cast<std::size_t>(group.begin)].t;
    CHECK(engine.remove_observation(group.landmark, t));
  }

  void degenerate() {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    if (truth_.empty()) return;
    const int j = random_.below(static_cast<int>(truth_.size()));
    CHECK_FALSE(engine.add_observation(j, {newest() + 1.0, {120.0, 90.0}, 1.0}));
    CHECK_FALSE(engine.add_observation(j, {-1.0, {120.0, 90.0}, 1.0}));
    CHECK_FALSE(engine.add_observation(j, {newest(), {kNaN, 90.0}, 1.0}));
    CHECK_FALSE(engine.add_observation(j, {kNaN, {120.0, 90.0}, 1.0}));
    if (engine.graph().states.size() < 2) return;
    const SE3 T = true_pose(newest());
    const Vector3 far = T * Vector3(1e5, -2e5, 1e6), behind = T * Vector3(0.1, 0.2, -3.0);
    truth_.push_back(random_.chance(0.5) ? far : behind);
    const bool prior = random_.chance(0.5);
    const int strange = engine.add_landmark(truth_.back(), prior ? LandmarkPrior{truth_.back(), 1.0} : LandmarkPrior{});
    engine.add_observation(strange, {newest(), {random_.uniform(0, 240), random_.uniform(0, 180)}, 1.0});
  }
};

}  // namespace

TEST_CASE("Whatever is added, removed, ended or comes late, no estimate becomes NaN and optimising finds an optimum") {
  for (int sequence = 0; sequence < kSequences; ++sequence) {
    CAPTURE(sequence);
    Session session(static_cast<unsigned>(sequence), {});
    for (int i = 0; i < kOperations; ++i) session.operate();
    session.update();
    const auto summary = session.engine.optimise(25, 1e-12);
    const double cost = evaluate(session.engine.graph()).total();
    REQUIRE(std::isfinite(cost));
    CHECK(summary.final_cost == Approx(cost));
    if (!summary.converged) continue;
    FactorGraph oracle = session.engine.graph();
    solve_batch(oracle, {25, 1e-9, 0});
    CHECK(cost <= evaluate(oracle).total() * (1.0 + 1e-5) + 1e-6);
  }
}

TEST_CASE("Redoing only what changed gives what redoing everything gives") {
  // Without relinearisation the problem is linear, and every order of operations must end at the same estimate.
  EngineOptions linear;
  linear.relinearise = linear.relinearise_redone = linear.check_step = std::numeric_limits<double>::infinity();
  linear.solve_tolerance = 0.0;
  int compared = 0;
  for (int sequence = 0; sequence < kSequences / 5; ++sequence) {
    CAPTURE(sequence);
    Session session(static_cast<unsigned>(sequence) + 1000000, linear);
    for (int i = 0; i < kOperations; ++i) session.operate();
    session.update();
    session.update();
    const FactorGraph before = session.engine.graph();
    session.engine.add_velocity_prior({0, Vector6::Zero(), Vector6::Constant(1e12)});  // concerns the oldest stage
    const UpdateSummary redone = session.engine.update();
    CHECK(redone.first_stage == 0);
    if (session.undetermined || !redone.reason.empty()) continue;  // what is held depends on when
    ++compared;
    for (std::size_t i = 0; i < before.states.size(); ++i) {
      const ControlState& now = session.engine.graph().states[i];
      CHECK((now.T.p - before.states[i].T.p).norm() < 1e-5 * (1.0 + before.states[i].T.p.norm()));
      CHECK((now.velocity - before.states[i].velocity).norm() < 1e-4 * (1.0 + before.states[i].velocity.norm()));
    }
  }
  CHECK(compared > kSequences / 20);
}

}  // namespace evbench::gp_map
