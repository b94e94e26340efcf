#include "eval/paired_comparison.hpp"

#include <cmath>
#include <limits>

#include "core/testing/catch2.hpp"
#include "eval/table_notes.hpp"
#include "eval/testing/runs.hpp"

namespace evbench {
namespace {

using namespace testing;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("Methods are compared by the ratios of their costs on the same data") {
  const std::vector<CostPair> pairs = {{1.0, 2.0}, {3.0, 4.0}, {2.0, 2.0}, {1.0, 4.0}, {9.0, 3.0}};
  const PairedComparison result = compare_pairs(pairs);
  CHECK(result.pairs == 5);
  CHECK(result.better == 3);
  CHECK(result.worse == 1);
  CHECK(result.ratio == Approx(0.75));
  CHECK(result.interval.from <= 0.75);
  CHECK(result.interval.to >= 0.75);
  CHECK(result.test.pairs == 4);  // differences of zero are left out
  CHECK(result.test.p == signed_rank_test(log_ratios(pairs)).p);
}

TEST_CASE("A failure is infinitely worse than any success, and two failures are equal") {
  const std::vector<CostPair> pairs = {{1.0, kInfinity}, {kInfinity, kInfinity}, {2.0, 1.0}, {1.0, kInfinity}};
  CHECK(log_ratios(pairs) == std::vector{-kInfinity, 0.0, std::log(2.0), -kInfinity});
  const PairedComparison result = compare_pairs(pairs);
  CHECK(result.own_failed == 1);
  CHECK(result.other_failed == 3);
  CHECK(result.better == 2);
  CHECK(result.worse == 1);
  CHECK(result.ratio == 0.0);
  CHECK(result.test.rank_biserial == Approx(-4.0 / 6.0));
}

TEST_CASE("Runs are paired by seed and source, different protocols and runs without the number make no pair") {
  Results results;
  for (const int seed : {1, 2, 3}) results.add_seed("mine", seed, 0.1 * seed);
  for (const int seed : {2, 3, 4}) results.add_seed("other", seed, 1.0 * seed);
  results.add_seed("other", 1, std::nullopt);
  const std::vector<RunRecord> records = results.find();
  std::vector<RunNumbers> runs = numbers_of(records, false);
  const std::vector<std::size_t> data = number_data(runs);
  std::vector<int> protocols = collect_protocols(runs).of_run;
  std::vector<std::size_t> mine, other;
  for (std::size_t i = 0; i < runs.size(); ++i) (records[i].label == "mine" ? mine : other).push_back(i);
  const Metric ate = metric_of("ate.trans_m.rmse"), pace = metric_of("realtime_factor");
  const auto pairs = [&](const Metric& metric) {
    return pair_up(costs_of(mine, runs, metric, data, protocols), costs_of(other, runs, metric, data, protocols));
  };
  REQUIRE(pairs(ate).size() == 3);
  CHECK(pairs(ate)[0].other == kInfinity);
  CHECK(pairs(ate)[1].own == 0.2);
  CHECK(pairs(ate)[1].other == 2.0);
  CHECK(pairs(pace)[1].own == Approx(1.0 / 1.5));  // higher is better: the cost is the inverse
  protocols[mine[1]] = 7;
  CHECK(pairs(ate).size() == 2);
}

}  // namespace evbench
