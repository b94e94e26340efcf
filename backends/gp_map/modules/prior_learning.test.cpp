#include "backends/gp_map/modules/prior_learning.hpp"

#include <cmath>

#include "core/smoother/testing/drawn_problem.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {
namespace {

constexpr double kTrue = 0.01;  // [rad²/s³, m²/s³]

/// Geometric mean over intervals and axes.
double mean_qc(const FactorGraph& graph) {
  double sum = 0.0;
  for (std::size_t k = 1; k < graph.qcs.size(); ++k) sum += graph.qcs[k].array().log().sum();
  return std::exp(sum / (6.0 * static_cast<double>(graph.qcs.size() - 1)));
}

}  // namespace

TEST_CASE("The prior from which a motion was drawn is estimated, starting a hundred times too strong or too weak") {
  for (const double start : {0.01, 1.0, 100.0}) {
    Smoother smoother = smoother::testing::DrawnProblem({.qc = kTrue, .pixel_sigma = 0.05}, 1).solve_incrementally();
    for (int k = 1; k < smoother::testing::DrawnProblem::kStates; ++k)
      smoother.set_qc(k, Vector6::Constant(start * kTrue));
    for (int round = 0; round < 6; ++round) {
      smoother.optimise(10, 1e-6);
      learn_prior(smoother, {});
    }
    CAPTURE(start);
    CHECK(mean_qc(smoother.graph()) == Approx(kTrue).epsilon(0.4));
  }
}

TEST_CASE("When a part is estimated again, its expansions keep their surplus over the prior's contraction") {
  Smoother smoother = smoother::testing::DrawnProblem({.qc = kTrue, .pixel_sigma = 0.05}, 1).solve_incrementally();
  for (int k = 1; k < smoother::testing::DrawnProblem::kStates; ++k)
    smoother.set_qc(k, Vector6::Constant(10.0 * kTrue), 20.0 + k);
  smoother.update();
  const std::vector<double> surplus = surplus_expansions(smoother);
  REQUIRE(surplus[1] > 10.0);  // it is not balanced
  for (int round = 0; round < 3; ++round) {
    learn_prior(smoother, {}, surplus);
    const std::vector<double> kept = surplus_expansions(smoother);
    for (std::size_t k = 1; k < surplus.size(); ++k) CHECK(kept[k] == Approx(surplus[k]).margin(1e-9));
    smoother.update();
  }
  learn_prior(smoother, {});
  for (const double balance : surplus_expansions(smoother)) CHECK(balance == Approx(0.0).margin(1e-9));
}

TEST_CASE("Evidence fades with time, and a guess counts where there is little evidence") {
  PriorEvidence sum{1.0, Vector6::Constant(4.0), Vector6::Constant(2.0)};
  CHECK(sum.qc(Vector6::Ones(), 0.0)[0] == Approx(2.0));
  CHECK(sum.qc(Vector6::Ones(), 2.0)[3] == Approx(1.5));
  sum.add({1.0 + 0.5, Vector6::Constant(8.0), Vector6::Constant(1.0)}, 0.5);
  CHECK(sum.square[2] == Approx(4.0 + 8.0 / std::exp(1.0)));
  CHECK(sum.freedom[5] == Approx(2.0 + 1.0 / std::exp(1.0)));
  sum.square << 1.0, 2.0, 3.0, 40.0, 50.0, 60.0;
  sum.freedom.setOnes();
  CHECK(sum.common_qc(Vector6::Ones(), 0.0)[1] == Approx(2.0));
  CHECK(sum.common_qc(Vector6::Ones(), 0.0)[5] == Approx(50.0));
}

}  // namespace evbench::gp_map
