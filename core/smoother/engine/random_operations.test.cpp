#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/smoother/batch_solver.hpp"
#include "core/smoother/cost.hpp"
#include "core/smoother/testing/random_session.hpp"
#include "core/smoother/testing/rounding.hpp"
#include "core/testing/catch2.hpp"

// 5,000 random sequences of all operations of the engine, sensible or not, compared with the batch solver, with redoing
// everything, or with full history. EVBENCH_RANDOM_SEQUENCES sets their number (./test.sh long: 100,000),
// EVBENCH_RANDOM_FIRST the number of the first one. So many sequences can be spread over processes, and a failed one
// can be repeated alone.
namespace evbench::smoother {
namespace {

using testing::linear_options;
using testing::RandomSession;
using testing::rounding_bounds;
using testing::RoundingBound;
using testing::SessionOptions;

constexpr int kSequences = 5000;
constexpr int kFew = 200;  ///< sequences; shares are not checked below this number

int from_environment(const char* name, int otherwise) {
  const char* value = std::getenv(name);
  return value == nullptr ? otherwise : std::atoi(value);
}

/// Calls play(seed) for each sequence of a fifth of them all. The seeds of the fifths do not overlap.
template <class Play>
void play_fifth(int fifth, Play play) {
  constexpr int kApart = 100'000'000;
  const int first = from_environment("EVBENCH_RANDOM_FIRST", 0);
  const int count = (from_environment("EVBENCH_RANDOM_SEQUENCES", kSequences) + 4) / 5;
  for (int sequence = first; sequence < first + count; ++sequence) {
    CAPTURE(sequence);
    play(static_cast<std::uint64_t>(fifth) * kApart + static_cast<std::uint64_t>(sequence));
  }
}

/// Thresholds and cache sizes that differ between sequences.
SmootherOptions draw_options(SmootherOptions options, std::uint64_t seed) {
  options.grace = 1 + static_cast<int>(seed % 3);
  options.kept_intervals = seed % 2 == 0 ? 64 : 3;
  options.reach = seed % 5 == 0 ? 4 : 128;
  options.redone_for_return = static_cast<int>(seed / 5 % 3);
  return options;
}

MotionPrior draw_prior(std::uint64_t seed) { return seed % 7 < 3 ? MotionPrior{20.0} : MotionPrior{}; }

/// Checks equality to 1e-7, or to the bound of rounding in a few ill-conditioned problems.
class Agreement {
 public:
  /// Compares the states from `first` on of one linear problem, solved by two methods.
  void check(const FactorGraph& a, const FactorGraph& b, int first, const RandomSession& session) {
    ++compared_;
    usual_ += a.motion_prior.has_acceleration() ? 6e-3 : 1e-3;
    std::vector<RoundingBound> bounds;
    for (auto i = static_cast<std::size_t>(first); i < a.states.size(); ++i) {
      const double position = (a.states[i].T.p - b.states[i].T.p).norm();
      const double velocity = (a.states[i].velocity - b.states[i].velocity).norm();
      if (position < 1e-7 * (1.0 + b.states[i].T.p.norm()) && velocity < 1e-6 * (1.0 + b.states[i].velocity.norm()))
        continue;
      if (bounds.empty()) {
        bounds = rounding_bounds(session.linear_problem());
        ++ill_conditioned_;
      }
      CAPTURE(i);
      CHECK(position < bounds[i].position);
      CHECK(velocity < bounds[i].velocity);
    }
  }

  /// Most sequences must have been compared, nearly all of them to 1e-7; otherwise the test shows nothing.
  void check_shares(int all) const {
    if (all < kFew) return;
    CHECK(compared_ > 0.3 * all);
    // In few comparisons chance may exceed the usual number: allowed are three Poisson deviations more.
    CHECK(ill_conditioned_ < std::max(2.0 * usual_, usual_ + 3.0 * std::sqrt(usual_)));
  }

 private:
  int compared_ = 0, ill_conditioned_ = 0;
  double usual_ = 0.0;  ///< ill-conditioned ones: a thousandth, of those with accelerations six
};

void play(RandomSession& session) {
  for (int i = session.draw_length(); i > 0; --i) session.operate();
}

/// Returns whether the engine converged.
bool compare_with_batch(std::uint64_t seed) {
  RandomSession session(seed, {.engine = draw_options({}, seed), .motion_prior = draw_prior(seed)});
  play(session);
  session.update();
  Smoother& engine = session.engine();
  const auto summary = engine.optimise(25, 1e-12);
  const double cost = evaluate(engine.graph()).total();
  REQUIRE(std::isfinite(cost));
  CHECK(summary.final_cost == Approx(cost));
  session.check_covariances();
  if (!summary.converged) return false;
  FactorGraph oracle = engine.graph();
  solve_batch(oracle, {.max_iterations = 25, .relative_tolerance = 1e-9});
  CHECK(cost <= evaluate(oracle).total() * (1.0 + 1e-5) + 1e-6);
  return true;
}

/// One of two halves, to be run in parallel.
void compare_all_with_batch(int fifth) {
  int converged = 0, all = 0;
  play_fifth(fifth, [&](std::uint64_t seed) {
    ++all;
    if (compare_with_batch(seed)) ++converged;
  });
  // The others have undetermined landmarks and take more than 25 iterations.
  CHECK((all < kFew || converged > 0.6 * all));
}

}  // namespace

TEST_CASE("After random operations optimise() ends no higher than the batch solver that starts there, half 1",
          "[random]") {
  compare_all_with_batch(0);
}

TEST_CASE("After random operations optimise() ends no higher than the batch solver that starts there, half 2",
          "[random]") {
  compare_all_with_batch(1);
}

TEST_CASE("In linear problems, redoing only what changed gives the states of redoing everything and of a new engine",
          "[random]") {
  Agreement agreement;
  int all = 0;
  play_fifth(2, [&](std::uint64_t seed) {
    ++all;
    const SmootherOptions options = draw_options(linear_options(), seed);
    RandomSession session(seed, {.engine = options, .motion_prior = draw_prior(seed), .anchor = false});
    play(session);
    session.update();
    Smoother& engine = session.engine();
    const FactorGraph before = engine.graph();
    engine.add_velocity_prior({0, Vector6::Zero(), Vector6::Constant(1e12)});  // affects the oldest stage
    const UpdateSummary redone = engine.update();
    CHECK(redone.first_stage == 0);
    Smoother fresh(session.linear_problem(), options);  // has linearised nothing yet
    const UpdateSummary first = fresh.update();
    // Which variables are regularised depends on when they are solved.
    if (session.undetermined() || !redone.reason.empty() || !first.reason.empty()) return;
    agreement.check(before, engine.graph(), 0, session);
    agreement.check(before, fresh.graph(), 0, session);
  });
  agreement.check_shares(2 * all);
}

TEST_CASE("An observation linearised close to the camera loses the digits that rounding explains, and no others") {
  int compared = 0, beyond_usual = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    CAPTURE(seed);
    const SmootherOptions options = draw_options(linear_options(), seed);
    RandomSession session(seed, {.engine = options, .anchor = false});
    for (int i = 0; i < 30; ++i) session.operate();
    session.update();
    const int close = session.add_close_landmark(1e-4);
    session.update();
    if (session.undetermined()) continue;
    ++compared;
    FactorGraph problem = session.linear_problem();
    Smoother fresh(problem, options);
    fresh.update();
    const double difference = (session.engine().graph().states.back().T.p - fresh.graph().states.back().T.p).norm();
    const double bound = rounding_bounds(problem).back().position;
    CHECK(difference < bound);
    if (difference > 1e-7) ++beyond_usual;
    problem.remove_landmark(close);
    CHECK(rounding_bounds(problem).back().position < 1e-3 * bound);
  }
  CHECK(compared > 20);
  CHECK(beyond_usual > 0);
}

TEST_CASE("With a lag the states equal those of full history in linear problems", "[random]") {
  Agreement agreement;
  int marginalised = 0, all = 0;
  play_fifth(3, [&](std::uint64_t seed) {
    ++all;
    SessionOptions options{.engine = draw_options(linear_options(), seed),
                           .motion_prior = draw_prior(seed),
                           .anchor = false,
                           .full_twin = true};
    options.engine.lag = 0.1 + 0.2 * static_cast<double>(seed % 5);
    RandomSession session(seed, options);
    play(session);
    session.update();
    if (session.undetermined()) return;
    marginalised += session.engine().first_state() > 0 ? 1 : 0;
    agreement.check(session.engine().graph(), session.twin().graph(), session.engine().first_state(), session);
  });
  agreement.check_shares(all);
  CHECK((all < kFew || marginalised > 0.1 * all));
}

TEST_CASE("With a lag no more is kept than the lag and the spacing of snapshots require, after random operations",
          "[random]") {
  play_fifth(4, [](std::uint64_t seed) {
    SessionOptions options{.engine = draw_options({}, seed), .motion_prior = draw_prior(seed)};
    options.engine.lag = 0.1 + 0.2 * static_cast<double>(seed % 5);
    RandomSession session(seed, options);
    play(session);
    session.update();
    if (session.engine().update().damping > 0.0) return;  // nothing is marginalised from damped stages
    const auto& states = session.engine().graph().states;
    const double from = states.back().t - options.engine.lag;
    const auto needed = std::ranges::find_if(states, [&](const ControlState& s) { return s.t >= from; });
    constexpr int kSpacing = 8;
    CHECK(needed - states.begin() <= session.engine().first_state() + kSpacing);
  });
}

}  // namespace evbench::smoother
